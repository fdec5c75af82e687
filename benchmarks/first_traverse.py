"""First traverse on many seeds, by vision and by dead reckoning: reached, errors, wall time.

    python benchmarks/first_traverse.py                     # geometric tier, seeds 0-39, both trees
    python benchmarks/first_traverse.py --tier full --seeds 5 --trees navigate

Each run is a fresh process, so that nothing is shared; two at a time.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

LONGARM = Path(sys.executable).with_name("longarm")


def one(mission: str, tree: str, tier: str, seed: int, folder: Path) -> dict:
    command = [
        *(str(LONGARM), "run", mission, "--tier", tier, "--seed", str(seed), "--json", "--quiet"),
        *("--set", f"mission.tree={tree}", "--out", str(folder / f"{tree}-{seed}")),
    ]
    done = subprocess.run(command, capture_output=True, text=True)
    try:
        result = json.loads(done.stdout)
    except json.JSONDecodeError:
        return {"seed": seed, "outcome": "crash", "reason": done.stderr[-300:]}
    return result | {"exit": done.returncode}


def row(tree: str, results: list[dict]) -> str:
    good = [r for r in results if r["outcome"] == "reached"]
    ran = [r for r in results if r["outcome"] != "crash"]
    errors = np.array([r["truth"]["final_error_m"] for r in ran]) * 1e3
    beyond = sum((r["truth"]["driven_beyond_off_track_m"] or 0.0) > 0.0 for r in ran)
    within = sum(within_tolerance(r) for r in ran)
    walls = np.array([r["wall_s"] for r in ran])
    return (
        f"{tree:16s} claimed {len(good):2d}/{len(results)}  truly within tolerance {within:2d}  "
        f"beyond margin {beyond}  final error median {np.median(errors):6.1f} mm p95 "
        f"{np.percentile(errors, 95):6.1f} mm  wall median {np.median(walls):5.1f} s max {walls.max():5.1f} s"
    )


TOLERANCES_M = (0.030, 0.030, 0.025, 0.025)


def within_tolerance(result: dict) -> bool:
    """Every way-point reached, within its tolerance by true position."""
    errors = result["truth"]["waypoint_errors_m"] or []
    return len(errors) == len(TOLERANCES_M) and all(e <= t for e, t in zip(errors, TOLERANCES_M, strict=True))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--mission", default="missions/first_traverse.yaml")
    parser.add_argument("--tier", default="geometric")
    parser.add_argument("--seeds", type=int, default=40)
    parser.add_argument("--trees", nargs="+", default=["navigate", "dead_reckoning"])
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args()
    with TemporaryDirectory() as folder, ThreadPoolExecutor(options.jobs) as pool:
        for tree in options.trees:
            jobs = [
                pool.submit(one, options.mission, tree, options.tier, seed, Path(folder))
                for seed in range(options.seeds)
            ]
            results = [job.result() for job in jobs]
            print(row(tree, results), flush=True)
            for result in results:
                if result["outcome"] != "reached" and tree != "dead_reckoning":
                    print("   ", result["seed"], result["outcome"], result["reason"])


if __name__ == "__main__":
    main()
