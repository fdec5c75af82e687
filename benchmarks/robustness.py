"""One mission over many kinds of ground, light, margin and range: what comes of it, and what must never.

    python benchmarks/robustness.py                     # geometric tier, every case, seeds 0-1
    python benchmarks/robustness.py --tier full --seeds 1 --cases low_sun high_sun
    python benchmarks/robustness.py --cases craters --seeds 10

Never: driving beyond the off-track margin, an error, a way-point claimed that truth puts outside its
tolerance. These end the benchmark with exit code 1; a call for help does not. Each run is a fresh process.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import yaml

LONGARM = Path(sys.executable).with_name("longarm")
MISSION = "missions/first_traverse.yaml"
GROUND = "world.terrain.procedural"


def route(*points: tuple[float, float]) -> str:
    """The option that replaces the way-points by these [m]."""
    listed = ", ".join(f"{{x: {x} m, y: {y} m}}" for x, y in points)
    return f"mission.waypoints=[{listed}]"


CASES: dict[str, tuple[str, ...]] = {
    "as_it_is": (),
    "crust": ("world.soil.default=crust",),
    "gravel": ("world.soil.default=gravel",),
    "bedrock": ("world.soil.default=bedrock",),
    "roughness_4_mm": (f"{GROUND}.roughness=4 mm",),
    "roughness_12_mm": (f"{GROUND}.roughness=12 mm",),
    "roughness_16_mm": (f"{GROUND}.roughness=16 mm",),
    "no_rocks": (f"{GROUND}.rocks=0",),
    "60_rocks": (f"{GROUND}.rocks=60",),
    "craters": (f"{GROUND}.craters=60",),
    "slope_up": (f"{GROUND}.slope=8 deg",),
    "slope_down": (f"{GROUND}.slope=8 deg", f"{GROUND}.slope_direction=180 deg"),
    "slope_across": (f"{GROUND}.slope=8 deg", f"{GROUND}.slope_direction=90 deg"),
    "small_margins": (
        "mission.segments={on_track: 20 mm, off_track: 120 mm, tolerance: 15 mm}",
        route((2.2, -0.5), (3.1, -0.2), (3.9, 0.5), (4.6, 1.2)),
    ),
    "sideways": (route((3.0, -1.2), (3.0, 0.0), (3.1, 1.2)),),
    "towards_the_lander": (route((4.5, 0.6), (3.6, 0.2), (2.4, 0.0)),),
    "and_back": (route((2.4, 0.0), (3.4, 0.3), (2.4, 0.6)),),
    "to_8_m": (route((6.0, -0.4), (7.0, 0.0), (8.0, 0.4)),),
    "to_12_m": (route((10.5, -0.4), (11.3, 0.0), (12.0, 0.4)),),
    "mast_1.2_m": ("world.mast_height=1.2 m",),
    "mast_2_m": ("world.mast_height=2 m",),
    "low_sun": ("world.light.sun_elevation=15 deg",),
    "high_sun": ("world.light.sun_elevation=60 deg",),
}


@dataclass(frozen=True)
class Verdict:
    """One run: how it ended, and what must never have happened."""

    case: str
    seed: int
    outcome: str
    reason: str | None
    never: tuple[str, ...]
    figures: str


def one(case: str, tier: str, seed: int, folder: Path) -> Verdict:
    options = [part for value in CASES[case] for part in ("--set", value)]
    command = [
        str(LONGARM),
        "run",
        MISSION,
        "--tier",
        tier,
        "--seed",
        str(seed),
        "--json",
        "--out",
        str(folder),
    ]
    done = subprocess.run([*command, *options], capture_output=True, text=True)
    try:
        result = json.loads(done.stdout)
    except json.JSONDecodeError:
        return Verdict(case, seed, "crash", done.stderr[-400:], ("crash",), "")
    never = tuple(breaches(result, tolerances_m(folder)))
    return Verdict(case, seed, result["outcome"], result["reason"], never, figures_of(result))


def tolerances_m(folder: Path) -> list[float]:
    """Tolerance of each way-point in the resolved scenario; the start's is that of the first segment."""
    mission = yaml.safe_load((folder / "scenario.yaml").read_text())["mission"]
    ends = [w.get("tolerance", mission["segments"]["tolerance"]) for w in mission["waypoints"][1:]]
    metres = [float(str(end).split()[0]) for end in ends]
    return [metres[0], *metres]


def breaches(result: dict, tolerances: list[float]) -> list[str]:
    truth, found = result["truth"], []
    if (truth["driven_beyond_off_track_m"] or 0.0) > 0.0:
        found.append(f"drove {truth['driven_beyond_off_track_m']:.3f} m beyond the margin")
    if result["outcome"] == "error":
        found.append("error")
    for index, (error, limit) in enumerate(zip(truth["waypoint_errors_m"] or [], tolerances, strict=False)):
        if error > limit:
            found.append(f"way-point {index} claimed at {error * 1e3:.0f} mm, tolerance {limit * 1e3:.0f} mm")
    return found


def figures_of(result: dict) -> str:
    truth, seen = result["truth"], result["localisation"]
    tried = Counter(row["name"] for row in result["strategies"])
    final, cross = truth["final_error_m"], truth["max_cross_track_m"]
    nees = "-" if seen["nees_mean"] is None else f"{seen['nees_mean']:.1f}"
    return (
        f"final {final * 1e3:6.1f} mm  cross {(cross or 0) * 1e3:4.0f} mm  "
        f"tilt {truth['max_tilt_deg']:4.1f} deg  "
        f"fixes {seen['count']:3d} ({seen['failed']} failed)  nees {nees}  "
        f"{result['mission_s']:6.0f} s in {result['wall_s']:5.1f} s  {dict(tried) or ''}"
    )


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--tier", default="geometric")
    parser.add_argument("--seeds", type=int, default=2)
    parser.add_argument("--cases", nargs="+", choices=list(CASES), default=list(CASES))
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args()
    verdicts = []
    with TemporaryDirectory() as folder, ThreadPoolExecutor(options.jobs) as pool:
        jobs = [
            pool.submit(one, case, options.tier, seed, Path(folder) / f"{case}-{seed}")
            for case in options.cases
            for seed in range(options.seeds)
        ]
        for job in jobs:
            v = job.result()
            verdicts.append(v)
            print(f"{v.case:20s} {v.seed:2d} {v.outcome:10s} {v.figures}", flush=True)
            for label, text in [("why", v.reason), *(("NEVER", n) for n in v.never)]:
                if text is not None:
                    print(f"{'':24s}{label}: {text}", flush=True)
    ends = Counter(v.outcome for v in verdicts)
    bad = [v for v in verdicts if v.never]
    print(f"{len(verdicts)} runs: {dict(ends)}; {len(bad)} with what must never happen")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
