"""The lint that keeps wall time and global randomness out, shown to be clean and shown to fire."""

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = ("executive", "strategies", "perception", "sim_pybullet", "proving")


def banned(*arguments: str, given: str | None = None) -> subprocess.CompletedProcess[str]:
    """Run the banned-API rule with the project's own configuration; `given` is source on standard input."""
    command = [sys.executable, "-m", "ruff", "check", "--no-cache", "--select", "TID251"]
    command += ["--config", str(ROOT / "pyproject.toml"), "--output-format", "concise", *arguments]
    return subprocess.run(command, cwd=ROOT, input=given, capture_output=True, text=True, check=False)


def test_no_package_reads_the_wall_clock():
    found = banned(*PACKAGES)
    assert found.returncode == 0, found.stdout


@pytest.mark.parametrize(
    "offence",
    [
        "import time\n",
        "from time import monotonic\n",
        "import datetime\n",
        "from datetime import datetime\n",
        "import random\n",
        "import numpy as np\n\nnp.random.seed(1)\n",
        "import py_trees.timers\n",
        "from py_trees.timers import Timer\n",
        "from py_trees.decorators import Timeout\n",
        "import py_trees\n\npy_trees.decorators.Timeout\n",
        "from py_trees.trees import BehaviourTree\n\nBehaviourTree.tick_tock\n",
    ],
)
@pytest.mark.parametrize("package", ["executive", "strategies"])
def test_a_planted_offence_is_found(package, offence):
    found = banned("--stdin-filename", f"{package}/planted.py", "-", given=offence)
    assert found.returncode == 1
    assert "TID251" in found.stdout


def test_the_clock_is_the_one_place_allowed():
    source = (ROOT / "executive" / "core" / "clock.py").read_text()
    assert banned("--stdin-filename", "executive/core/clock.py", "-", given=source).returncode == 0
    assert banned("--stdin-filename", "executive/other.py", "-", given=source).returncode == 1


def test_no_ignore_in_a_package_lifts_the_ban():
    lifted = [
        f"{path.relative_to(ROOT)}:{number}"
        for package in PACKAGES
        for path in (ROOT / package).rglob("*.py")
        for number, line in enumerate(path.read_text().splitlines(), start=1)
        if "noqa" in line and ("TID251" in line or line.rstrip().endswith("# noqa"))
    ]
    assert lifted == []
