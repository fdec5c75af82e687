"""What is installed: a lock of what the project asks for, by hash; a wheel that keeps to its own names."""

import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from packaging.markers import default_environment
from packaging.requirements import Requirement

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
ENTRIES = re.split(r"\n(?=[a-z])", (ROOT / "requirements.lock").read_text().split("make lock\n")[1])
LOCKED = [Requirement(entry.splitlines()[0].removesuffix("\\")) for entry in ENTRIES]
PYTHONS = ("3.11", "3.12", "3.13")
DATA = ("trees", "missions", "scenarios", "campaigns")


def wanted():
    project = PROJECT["project"]
    return [
        *project["dependencies"],
        *project["optional-dependencies"]["dask"],
        *PROJECT["dependency-groups"]["dev"],
    ]


def on(requirement, python):
    """Whether it is for this version of Python, on a machine like this one."""
    environment = default_environment() | {"python_version": python, "python_full_version": f"{python}.5"}
    return requirement.marker is None or requirement.marker.evaluate(environment)


def plain(name):
    return re.sub(r"[-_.]+", "-", name).lower()


@pytest.mark.parametrize("python", PYTHONS)
def test_the_lock_has_what_the_project_asks_for(python):
    locked = {plain(r.name): str(r.specifier).removeprefix("==") for r in LOCKED if on(r, python)}
    for requirement in map(Requirement, wanted()):
        if on(requirement, python):
            assert requirement.specifier.contains(locked[plain(requirement.name)]), requirement


@pytest.mark.parametrize("python", PYTHONS)
def test_each_python_has_one_pybullet(python):
    assert len([r for r in LOCKED if r.name.startswith("pybullet") and on(r, python)]) == 1


def test_every_package_of_the_lock_has_hashes_and_no_address():
    assert len(LOCKED) > 50
    for entry in ENTRIES:
        assert re.match(r"[a-z0-9.-]+==", entry), entry
        assert re.search(r"--hash=sha256:[0-9a-f]{64}", entry), entry
        assert "://" not in entry


def test_the_wheel_packs_data_under_one_name(tmp_path):
    build = ["egg_info", "--egg-base", tmp_path, "build", "--build-base", tmp_path]
    subprocess.run([sys.executable, "setup.py", "-q", *build], cwd=ROOT, check=True, capture_output=True)
    built = tmp_path / "lib"
    for folder in DATA:
        assert not (built / folder).exists()
        assert files(built / "longarm" / "data" / folder, "*.yaml") == files(ROOT / folder, "*.yaml") != set()
    packed, template = (at / "templates" for at in (built / "longarm" / "data", ROOT))
    assert files(packed) == files(template)


def files(folder, pattern="*"):
    found = (path for path in folder.rglob(pattern) if path.is_file() and path.suffix != ".pyc")
    return {path.relative_to(folder) for path in found}
