"""Outlines in both tiers: are the cheap tier's poses as far off as those of images?

    python -m benchmarks.outline_model [--trials 100] [--ranges 3 6 10 15 20]

Prints a row a range and a tier: share of outlines that gave a pose, errors (root mean square) along and
across the line of sight and of yaw, mean NEES of these three. Head, joints and inclinometers err anew in each
trial; in images the sun is known. Ends with 1 where the tiers differ by more than a factor of three in an
error, or one is more sure than it may be.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass

import cv2
import numpy as np

from executive.core.types import HeadReading, Shot
from perception.geometry.pose import roll_pitch
from perception.markers.marker_fix import MarkerFix
from perception.markers.plausibility import choose
from perception.markers.single import find_candidates
from sim_pybullet.geometric import CentreDeveloper
from sim_pybullet.leds import MarkerOptics
from sim_pybullet.radiometry import Exposure, calibrated_light
from sim_pybullet.raycast import HeightField
from tests.perception.passive_trials import FRAMES, RIG, Trial, Wrong, draw, judged, run_trial

RANGES_M = (3.0, 6.0, 10.0, 15.0, 20.0)
MOST_RATIO, MOST_NEES = 3.0, 6.0
HEAD = (
    "range       tier trials  found   along  across    yaw   mean\n"
    "  [m]                            [mm]    [mm]  [deg]   NEES"
)
_PLANAR = [0, 1, 5]
_SEED = 45


@dataclass(frozen=True)
class Row:
    """One tier at one range."""

    range_m: float
    tier: str
    trials: int
    found: float
    rms: np.ndarray
    nees: float

    @classmethod
    def of(cls, range_m: float, tier: str, trials: list[Trial]) -> Row:
        had = [t for t in trials if t.error is not None]
        errors = np.array([t.error for t in had]).reshape(-1, 6)[:, _PLANAR]
        nees = [
            e @ np.linalg.solve(t.covariance[np.ix_(_PLANAR, _PLANAR)], e)
            for t, e in zip(had, errors, strict=True)
        ]
        rms = np.sqrt((errors**2).mean(axis=0)) if had else np.full(3, np.nan)
        return cls(range_m, tier, len(trials), len(had) / len(trials), rms, float(np.mean(nees or [np.nan])))

    def __str__(self) -> str:
        along, across, yaw = self.rms * (1e3, 1e3, np.degrees(1.0))
        return (
            f"{self.range_m:5.0f} {self.tier:>10} {self.trials:6d} {self.found:6.2f}"
            f" {along:7.1f} {across:7.2f} {yaw:6.2f} {self.nees:6.2f}"
        )


def cheap(range_m: float, rng: np.random.Generator) -> Trial:
    """One outline of the geometric tier, as the localizer uses it."""
    s = draw(range_m, Wrong.NOTHING, rng)
    field, state = HeightField(s.terrain), s.expectation.state
    optics = MarkerOptics(RIG, calibrated_light(RIG), field)
    developer = CentreDeveloper(optics, Exposure(RIG.sensor.bits), field, rng)
    head = HeadReading(0.0, *state.head_rad, moving=False)
    centres = developer.develop(Shot((0,) * FRAMES, s.windows), (s.scene,) * FRAMES, head, 0.0)
    if not np.isfinite(centres.uv_px).all():
        return Trial(None, None, 0.0, "no outline")
    candidates = find_candidates(RIG, centres, range_m).candidates
    tilt_rad = (float(a) for a in roll_pitch(state.site_body.rotation)[0])
    found = choose(
        s.chain, candidates, state.head_rad, state.joints_rad, tuple(tilt_rad), s.expectation.prior
    )
    if not isinstance(found, MarkerFix):
        return Trial(None, None, 0.0, found.why)
    return judged(s, found.fit.state.site_body, found.fit.covariance, 0.0)


TIERS = {"full": run_trial, "geometric": cheap}


def one(range_m: float, tier: str, index: int) -> Trial:
    """A trial with draws of its own, the same scene in both tiers."""
    cv2.setNumThreads(1)
    return TIERS[tier](range_m, np.random.default_rng([_SEED, round(10 * range_m), index]))


def failures(full: Row, geometric: Row) -> list[str]:
    """What should hold between the tiers and does not."""
    ratio = geometric.rms[[0, 2]] / full.rms[[0, 2]]
    checks = [
        (1 / MOST_RATIO <= r <= MOST_RATIO, f"{name} {r:.1f} times that of images")
        for name, r in zip(("along", "yaw"), ratio, strict=True)
    ]
    checks += [(row.nees <= MOST_NEES, f"{row.tier} tier: NEES {row.nees:.1f}") for row in (full, geometric)]
    return [f"{full.range_m:g} m: {text}" for good, text in checks if not good]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--trials", type=int, default=100)
    parser.add_argument("--ranges", type=float, nargs="+", default=list(RANGES_M))
    options = parser.parse_args()
    wrong = []
    print(HEAD, flush=True)
    for range_m in options.ranges:
        rows = []
        for tier in TIERS:
            rows.append(Row.of(range_m, tier, [one(range_m, tier, i) for i in range(options.trials)]))
            print(rows[-1], flush=True)
        wrong += failures(*rows)
    for failure in wrong:
        print(f"BOUND NOT HELD  {failure}")
    sys.exit(bool(wrong))


if __name__ == "__main__":
    main()
