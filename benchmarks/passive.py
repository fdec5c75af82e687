"""Where the rover is by its outline alone: all LEDs dead, daylight, images of the full tier.

    python -m benchmarks.passive [--trials 300] [--ranges 10 15 20] [--jobs 2]

Prints a row a range and a condition: share of fixes that converged (accepted, and not false), errors along
and across the line of sight and of yaw, false poses (accepted, but along, across or yaw off by more than 5 of
their own sigmas), mean NEES of these three, processing time. Then with a survey that is 20 mm wrong, and with
a background of another place: how often that was said. Ends with 1 if a bound does not hold.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial

import cv2
import numpy as np

from tests.perception.passive_trials import Trial, Wrong, run_trial

RANGES_M = (10.0, 15.0, 20.0)
LEAST_CONVERGED, LEAST_SAID, MOST_FALSE = 0.95, 0.90, 0.005
MOST_ACROSS_M, MOST_YAW_RAD = 0.005, np.radians(1.0)
MOST_ALONG_M = {20.0: 0.060}
_PLANAR = [0, 1, 5]
_SEED = 44


@dataclass(frozen=True)
class Row:
    """One range under one condition, in figures; lengths [m], angles [rad]."""

    range_m: float
    wrong: Wrong
    trials: int
    accepted: float
    false: float
    along_m: float
    across_m: float
    yaw_rad: float
    nees: float
    seconds: float
    reasons: tuple[tuple[str, int], ...]

    @classmethod
    def of(cls, range_m: float, wrong: Wrong, trials: list[Trial]) -> Row:
        accepted = [t for t in trials if t.error is not None]
        errors = np.array([t.error for t in accepted]).reshape(-1, 6)[:, _PLANAR]
        nees = [
            e @ np.linalg.solve(t.covariance[np.ix_(_PLANAR, _PLANAR)], e)
            for t, e in zip(accepted, errors, strict=True)
        ]
        along, across, yaw = np.sqrt((errors**2).mean(axis=0)) if accepted else (np.nan,) * 3
        reasons = Counter(_kind(t.why) for t in trials if t.why)
        return cls(
            range_m,
            wrong,
            len(trials),
            len(accepted) / len(trials),
            sum(t.false for t in trials) / len(trials),
            float(along),
            float(across),
            float(yaw),
            float(np.mean(nees)) if nees else float("nan"),
            float(np.median([t.seconds for t in trials])),
            tuple(reasons.most_common()),
        )

    def failures(self) -> list[str]:
        """Bounds that do not hold."""
        checks = [(self.false <= MOST_FALSE, f"false poses {self.false:.2%}")]
        if self.wrong is Wrong.NOTHING:
            converged = self.accepted - self.false
            checks += [
                (converged >= LEAST_CONVERGED, f"converged {converged:.1%}"),
                (self.across_m <= MOST_ACROSS_M, f"across {self.across_m * 1e3:.1f} mm"),
                (self.yaw_rad <= MOST_YAW_RAD, f"yaw {np.degrees(self.yaw_rad):.2f} deg"),
                (
                    self.along_m <= MOST_ALONG_M.get(self.range_m, np.inf),
                    f"along {self.along_m * 1e3:.0f} mm",
                ),
            ]
        else:
            checks += [(1 - self.accepted >= LEAST_SAID, f"said so in {1 - self.accepted:.1%}")]
        return [f"{self.range_m:g} m, wrong {self.wrong}: {text}" for good, text in checks if not good]

    def __str__(self) -> str:
        return (
            f"{self.range_m:5.0f} {self.wrong:>10} {self.trials:6d} {self.accepted:9.3f} {self.false:6.3f}"
            f" {self.along_m * 1e3:7.1f} {self.across_m * 1e3:7.2f} {np.degrees(self.yaw_rad):6.2f}"
            f" {self.nees:6.2f} {self.seconds:6.2f}"
        )


HEAD = (
    "range      wrong trials  accepted  false   along  across    yaw   mean   time\n"
    "  [m]                                       [mm]    [mm]  [deg]   NEES    [s]"
)


def one(range_m: float, wrong: Wrong, index: int) -> Trial:
    """A trial with draws of its own, whoever runs it."""
    cv2.setNumThreads(1)
    draws = np.random.default_rng([_SEED, round(10 * range_m), list(Wrong).index(wrong), index])
    return run_trial(range_m, draws, wrong)


def _kind(why: str) -> str:
    """A reason without its figures."""
    return " ".join(word for word in why.split() if not any(c.isdigit() for c in word))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--trials", type=int, default=300)
    parser.add_argument("--ranges", type=float, nargs="+", default=list(RANGES_M))
    parser.add_argument("--wrong", type=Wrong, nargs="+", default=list(Wrong), choices=list(Wrong))
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args()
    failures = []
    print(HEAD, flush=True)
    with ProcessPoolExecutor(options.jobs) as pool:
        for wrong in options.wrong:
            for range_m in options.ranges:
                work = partial(one, range_m, wrong)
                row = Row.of(range_m, wrong, list(pool.map(work, range(options.trials), chunksize=4)))
                print(row, flush=True)
                for reason, count in row.reasons:
                    print(f"      {count:4d} refused: {reason}")
                failures += row.failures()
    for failure in failures:
        print(f"BOUND NOT HELD  {failure}")
    sys.exit(bool(failures))


if __name__ == "__main__":
    main()
