"""The same scenario and seed give the same record in any process; another seed gives another."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
MISSION = """\
scenario: hop
mission:
  mission: hop
  waypoints:
    - {x: 2.2 m, y: -0.5 m}
    - {x: 2.3 m, y: -0.5 m}
time_limit: {limit}
"""

pytestmark = pytest.mark.sim


def digest_of(
    folder: Path, seed: int, tier: str, out: str, hash_seed: str, threads: str = "2", limit: str = "2 h"
) -> str:
    """The digest of a run in a fresh process that works in `folder`, with so many threads to a product."""
    folder.mkdir(exist_ok=True)
    file = folder / "hop.yaml"
    file.write_text(MISSION.replace("{limit}", limit))
    command = [
        sys.executable,
        "-c",
        "from executive.cli import main; main()",
        "run",
        str(file),
        "--json",
    ]
    command += ["--seed", str(seed), "--tier", tier, "--out", out]
    environment = os.environ | {"PYTHONHASHSEED": hash_seed, "PYTHONPATH": str(ROOT)}
    environment |= {"OPENBLAS_NUM_THREADS": threads}
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode in (0, 1), done.stderr
    result = json.loads(done.stdout)
    assert (result["tier"], result["seed"]) == (tier, seed)
    assert result["localisation"]["count"] > 1
    return str(result["digest"])


@pytest.fixture(scope="module")
def geometric(tmp_path_factory: pytest.TempPathFactory) -> str:
    return digest_of(tmp_path_factory.mktemp("geometric"), 3, "geometric", "out", "0")


def test_a_seed_repeats_bit_for_bit_wherever_it_runs(geometric: str, tmp_path: Path) -> None:
    again = digest_of(tmp_path / "there", 3, "geometric", str(tmp_path / "elsewhere" / "out"), "4711")
    assert len(again) == 64
    assert again == geometric


def test_the_full_tier_repeats_bit_for_bit_on_any_number_of_cores(tmp_path: Path) -> None:
    runs = [(tmp_path / f"{n}", 3, "full", "out", f"{n}", f"{n}", "3 min") for n in (1, 2)]
    one, again = (digest_of(*each) for each in runs)
    assert again == one


def test_another_seed_makes_another_run(geometric: str, tmp_path: Path) -> None:
    assert digest_of(tmp_path, 4, "geometric", "out", "0") != geometric
