"""This package adds to the core through the registry alone: the core knows no word of it."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

CHECKOUT = Path(__file__).parents[3]
CORE = ("executive", "perception", "strategies", "proving")
WORDS = "yard|husky|aruco|battery|recharge|wheel_slip|marker_covered|camera_dark"


def git(*arguments: str) -> str:
    ended = subprocess.run(["git", *arguments], cwd=CHECKOUT, capture_output=True, text=True, check=False)
    assert ended.returncode in (0, 1), ended.stderr
    return ended.stdout


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The core's wheel, built from this checkout."""
    folder = tmp_path_factory.mktemp("wheel")
    command = [sys.executable, "-m", "pip", "wheel", "-q", "--no-deps", "--no-build-isolation"]
    subprocess.run([*command, "-w", str(folder), str(CHECKOUT)], check=True)
    return next(folder.glob("longarm-*.whl"))


def test_no_word_of_this_robot_is_in_the_core():
    assert git("grep", "-inEw", WORDS, "--", *CORE) == ""


@pytest.mark.slow
def test_wheel_holds_the_checkouts_core_and_nothing_else(wheel):
    with zipfile.ZipFile(wheel) as archive:
        packed = {
            name: hashlib.sha256(archive.read(name)).hexdigest()
            for name in archive.namelist()
            if name.split("/")[0] in CORE
        }
    committed = git("ls-files", "--", *CORE).splitlines()
    assert packed == {name: hashlib.sha256((CHECKOUT / name).read_bytes()).hexdigest() for name in committed}


@pytest.mark.slow
def test_mission_runs_on_the_installed_wheel_in_an_empty_folder(wheel, tmp_path):
    site, empty = tmp_path / "site", tmp_path / "empty"
    empty.mkdir()
    install = [sys.executable, "-m", "pip", "install", "-q", "--no-deps", "--no-build-isolation"]
    subprocess.run(
        [*install, "--target", str(site), str(wheel), str(CHECKOUT / "examples/yard_robot")], check=True
    )
    folders = ", ".join(str(site / "yard_robot" / name) for name in ("trees", "missions"))
    (empty / "longarm.yaml").write_text(
        f"paths: [{folders}]\ndefaults: {{backend: yard, localizer: yard_markers}}\n"
    )
    program = "import executive, sys; print(executive.__file__); from executive.cli import main; main()"
    scenario = site / "yard_robot" / "scenarios" / "yard_round.yaml"
    ended = subprocess.run(
        [sys.executable, "-P", "-c", program, "run", str(scenario), "--out", str(empty / "run")],
        cwd=empty,
        env=os.environ | {"PYTHONPATH": str(site)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert ended.stdout.startswith(str(site)), ended.stdout + ended.stderr
    assert ended.returncode == 0, ended.stdout + ended.stderr
