"""Twenty metres straight away from the lander, looked at from outside: did the head keep the rover in view?

    python -m benchmarks.far_drive [--tier geometric] [--seeds 5] [--jobs 2]
    python -m benchmarks.far_drive --tier full --seeds 1

Runs missions/far_drive.yaml and holds the record against the truth. *fixes*: precise localisations;
*outside*: those at which a true marker was not in both true frames; *failed*: looks that gave no pose;
*lost*: samples of the drive, a second each, in which the rover's true middle was not in both true frames
while its belts ran; *seen*: tendencies on the way, and how far off they were (95th percentile). Ends with 1
if a run does not reach the goal to 100 mm, true, or any look was outside or the rover lost.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from scipy.spatial.transform import Rotation

from executive.core.rig import RigCalibration
from executive.core.types import PoseEstimate, PoseSource
from executive.record.events import Telemetry, TruthEvent
from executive.record.history import At, History
from executive.record.result import vision_fixes
from executive.record.truth import PoseError, Track
from perception.geometry.body import Transform, points_in_body
from perception.geometry.chain import Chain

LONGARM = Path(sys.executable).with_name("longarm")
MISSION = "missions/far_drive.yaml"
MOST_ERROR_M = 0.100
CHAIN = Chain.of(RigCalibration())
_MIDDLE_BODY_M = np.array([[0.0, 0.0, CHAIN.rig.rover.height_m / 2]])
HEAD = (
    "seed   outcome  error  fixes outside failed  lost   seen    p95   wall\n"
    "                 [mm]                                      [mm]    [s]"
)


@dataclass(frozen=True)
class Drive:
    """One run in figures; lengths [m]."""

    seed: int
    outcome: str
    why: str
    error_m: float
    fixes: int
    outside: int
    failed: int
    lost: int
    tendency_m: np.ndarray
    wall_s: float

    def failures(self) -> list[str]:
        """Bounds that do not hold."""
        checks = (
            (self.outcome == "reached", f"{self.outcome}: {self.why}"),
            (self.error_m <= MOST_ERROR_M, f"goal missed by {self.error_m * 1e3:.0f} mm"),
            (self.outside == 0, f"{self.outside} fixes outside the stereoscopic overlap"),
            (self.lost == 0, f"rover out of view for {self.lost} s of its drive"),
        )
        return [f"seed {self.seed}: {text}" for good, text in checks if not good]

    def __str__(self) -> str:
        p95 = np.quantile(self.tendency_m, 0.95) if self.tendency_m.size else np.nan
        return (
            f"{self.seed:4d} {self.outcome:>9} {self.error_m * 1e3:6.0f} {self.fixes:6d} {self.outside:7d}"
            f" {self.failed:6d} {self.lost:5d} {self.tendency_m.size:6d} {p95 * 1e3:6.0f} {self.wall_s:6.0f}"
        )


def drive(tier: str, folder: Path, seed: int) -> Drive:
    """Run the mission in a process of its own and read what it left."""
    out = folder / f"{tier}-{seed}"
    command = [*(str(LONGARM), "run", MISSION, "--tier", tier, "--seed", str(seed))]
    done = subprocess.run([*command, "--json", "--quiet", "--out", str(out)], capture_output=True, text=True)
    try:
        result = json.loads(done.stdout)
    except json.JSONDecodeError:
        raise RuntimeError(f"seed {seed} left no result: {done.stderr[-500:]}") from None
    return judged(seed, result, out)


def judged(seed: int, result: dict, folder: Path) -> Drive:
    """The figures of a run from its result and its folder."""
    record, truth = History.of(folder / "record.mcap"), History.of(folder / "truth.mcap")
    samples, track = truth.all(TruthEvent), Track.of(truth)
    fixes = vision_fixes(record)
    moving = [at for at in record.all(Telemetry) if at.event.moving]
    first_fix_s = fixes[0].time_s if fixes else np.inf
    under_way = [_nearest(samples, at.time_s) for at in moving if at.time_s > first_fix_s]
    tendencies = [at.event for at in record.all(PoseEstimate) if at.event.source == PoseSource.TREND]
    return Drive(
        seed=seed,
        outcome=result["outcome"],
        why=result["reason"] or "",
        error_m=result["truth"]["final_error_m"],
        fixes=len(fixes),
        outside=sum(not _markers_in_view(_nearest(samples, fix.time_s)) for fix in fixes),
        failed=result["localisation"]["failed"],
        lost=sum(not _in_view(sample, _MIDDLE_BODY_M) for sample in under_way),
        tendency_m=np.array([np.linalg.norm(PoseError.of(track, t).position_m[:2]) for t in tendencies]),
        wall_s=result["wall_s"],
    )


def _nearest(samples: list[At[TruthEvent]], time_s: float) -> TruthEvent:
    times = np.array([at.time_s for at in samples])
    return samples[int(np.abs(times - time_s).argmin())].event


def _markers_in_view(true: TruthEvent) -> bool:
    """Whether both cameras, as they truly stood, had all markers in their frames."""
    return _in_view(
        true, points_in_body(CHAIN.rig.cabin, CHAIN.markers_plc_m, true.arm_rad, true.cabin_rad)[0]
    )


def _in_view(true: TruthEvent, points_body_m: np.ndarray) -> bool:
    body = Transform(Rotation.from_quat(true.quat_site_body).as_matrix(), np.array(true.position_site_m))
    head = CHAIN.site_ih((true.pan_rad, true.tilt_rad))
    uv = CHAIN.model.project(head.inverse().apply(body.apply(points_body_m)))
    return bool(CHAIN.model.inside(uv).all())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--tier", choices=("geometric", "full"), default="geometric")
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args()
    failures = []
    print(HEAD, flush=True)
    with TemporaryDirectory() as folder, ThreadPoolExecutor(options.jobs) as pool:
        for found in pool.map(partial(drive, options.tier, Path(folder)), range(options.seeds)):
            print(found, flush=True)
            failures += found.failures()
    for failure in failures:
        print(f"BOUND NOT HELD  {failure}")
    sys.exit(bool(failures))


if __name__ == "__main__":
    main()
