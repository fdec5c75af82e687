"""How far the rover can be seen, and how near the error is to the Cramer-Rao bound of the same images.

    python -m benchmarks.perception [--trials 300] [--ranges 1.6 3 5 7.5 10 15 20] [--real | --ideal | --dark]

Prints a row a range in three tables: still frames; frames that do what they do in the field (0.05 px of
jitter, 0.2 px of drift, 2 % of changing light, 10 % texture); and frames with the LEDs off, where whatever is
found is false. A row holds the share of trials detected and of false poses (accepted, but x, y or yaw off by
more than 5 of their own sigmas), RMS errors and their ratio to the bound, mean NEES with the band in which
95 % of such means lie, and the processing time of one localisation. False poses count as false and stay out
of errors and NEES. What a row should keep and does not is named below it; the exit code is then 1.
The tables go to docs/images/perception_table.txt, errors and bounds to a picture beside it.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import cv2
import numpy as np
from scipy.stats import binom, chi2

from benchmarks.perception_picture import draw
from tests.perception.far_trials import Nuisance, Trial, run_trial


@dataclass(frozen=True)
class Demand:
    """What must hold at a range: on/off pairs to use, error over bound."""

    pairs: int
    over_bound: float


DEMANDS = {
    1.6: Demand(1, 1.15),
    3.0: Demand(3, 1.15),
    5.0: Demand(8, 1.15),
    7.5: Demand(20, 1.2),
    10.0: Demand(50, 1.2),
    15.0: Demand(110, 1.3),
    20.0: Demand(300, 1.3),
}
DETECTED, FALSE = 0.99, 0.01
FALSE_ALARMS_CLAIMED = 1e-3  # in the dark
SCENES = {
    "ideal": Nuisance(),
    "real": Nuisance(jitter_px=0.05, drift_px=0.2, light=0.02, texture=0.10),
    "dark": Nuisance(jitter_px=0.05, drift_px=0.2, light=0.02, texture=0.10),
}
IMAGES = Path("docs/images")


@dataclass(frozen=True)
class Row:
    """One range: its trials in figures; lengths [m], angles [rad]."""

    range_m: float
    demand: Demand
    trials: int
    detected: int
    false: int
    position_m: float
    position_bound_m: float
    yaw_rad: float
    yaw_bound_rad: float
    nees: float
    seconds: float

    @classmethod
    def of(cls, range_m: float, demand: Demand, trials: list[Trial]) -> Row:
        accepted = [t for t in trials if t.detected]
        good = [t for t in accepted if not t.false]
        errors = np.array([t.error for t in good]).reshape(-1, 6)
        bounds = np.array([np.diag(t.bound) for t in good]).reshape(-1, 6)

        def root(squares: np.ndarray) -> float:
            return float(np.sqrt(squares.mean())) if len(squares) else float("nan")

        return cls(
            range_m,
            demand,
            len(trials),
            len(accepted),
            len(accepted) - len(good),
            root((errors[:, :3] ** 2).sum(axis=1)),
            root(bounds[:, :3].sum(axis=1)),
            root(errors[:, 5] ** 2),
            root(bounds[:, 5]),
            float(np.mean([t.nees for t in good])) if good else float("nan"),
            float(np.median([t.seconds for t in trials])),
        )

    @property
    def nees_band(self) -> tuple[float, float]:
        good = max(self.detected - self.false, 1)
        low, high = chi2.ppf((0.025, 0.975), 6 * good) / good
        return float(low), float(high)

    @property
    def over_bound(self) -> tuple[float, float]:
        """Of position and yaw."""
        return self.position_m / self.position_bound_m, self.yaw_rad / self.yaw_bound_rad

    def faults(self) -> Iterator[str]:
        """What a lit row does not keep."""
        low, high = self.nees_band
        if self.detected < DETECTED * self.trials:
            yield f"detected in {self.detected} of {self.trials}, {DETECTED:.0%} wanted"
        if self.false > FALSE * self.trials:
            yield f"{self.false} false of {self.trials}, {FALSE:.0%} allowed"
        for what, ratio in zip(("position", "yaw"), self.over_bound, strict=True):
            if not ratio <= self.demand.over_bound:
                yield f"{what} error {ratio:.3f} of the bound, {self.demand.over_bound} allowed"
        if not low <= self.nees <= high:
            yield f"mean NEES {self.nees:.2f} outside {low:.2f} to {high:.2f}"

    def dark_faults(self) -> Iterator[str]:
        """What a row without light does not keep: as many finds as the claimed rate seldom gives."""
        if binom.sf(self.detected - 1, self.trials, FALSE_ALARMS_CLAIMED) < 0.025:
            yield f"{self.detected} found of {self.trials} without light, {FALSE_ALARMS_CLAIMED:g} claimed"

    def __str__(self) -> str:
        low, high = self.nees_band
        position, yaw = self.over_bound
        return (
            f"{self.range_m:5.1f} {self.demand.pairs:5d} {self.detected / self.trials:9.3f}"
            f" {self.false / self.trials:6.3f} {self.position_m * 1e3:9.2f} {position:6.3f}"
            f" {np.degrees(self.yaw_rad):8.3f} {yaw:6.3f}"
            f" {self.nees:7.2f} {low:5.2f}..{high:4.2f} {self.seconds * 1e3:8.0f}"
        )

    @property
    def dark_line(self) -> str:
        return f"{self.range_m:5.1f} {self.demand.pairs:5d} {self.trials:9d} {self.detected:6d}"


LIT_HEAD = (
    "range pairs  detected  false  position  over       yaw  over    mean    95 % of     time\n"
    "  [m]                           [mm]   bound     [deg]  bound   NEES      means     [ms]"
)
DARK_HEAD = "range pairs    trials  found\n  [m]"


def one(range_m: float, pairs: int, scene: str, index: int) -> Trial:
    """A trial with draws of its own, whoever runs it."""
    cv2.setNumThreads(1)
    draws = np.random.default_rng([4, list(SCENES).index(scene), round(10 * range_m), pairs, index])
    return run_trial(range_m, pairs, draws, nuisance=SCENES[scene], dark=scene == "dark")


def table(scene: str, ranges: list[float], count: int, pool: ProcessPoolExecutor) -> tuple[list[Row], str]:
    """The rows of one scene and their text, printed as it grows."""
    rows, text = [], ""

    def say(line: str) -> None:
        nonlocal text
        print(line, flush=True)
        text += line + "\n"

    say(f"{scene}, {count} trials a row")
    say(DARK_HEAD if scene == "dark" else LIT_HEAD)
    for range_m in ranges:
        demand = DEMANDS[range_m]
        work = partial(one, range_m, demand.pairs, scene)
        trials = list(pool.map(work, range(count), chunksize=4))
        row = Row.of(range_m, demand, trials)
        rows.append(row)
        say(row.dark_line if scene == "dark" else str(row))
        for fault in row.dark_faults() if scene == "dark" else row.faults():
            say(f"      FAILS: {fault}")
    return rows, text


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--trials", type=int, default=300)
    parser.add_argument("--ranges", type=float, nargs="+", default=list(DEMANDS), choices=list(DEMANDS))
    for scene in SCENES:
        parser.add_argument(f"--{scene}", dest="scenes", action="append_const", const=scene)
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args()
    tables: dict[str, list[Row]] = {}
    texts = []
    with ProcessPoolExecutor(options.jobs) as pool:
        for scene in options.scenes or SCENES:
            tables[scene], text = table(scene, options.ranges, options.trials, pool)
            texts.append(text)
    if set(options.ranges) == set(DEMANDS) and not options.scenes:
        (IMAGES / "perception_table.txt").write_text("\n".join(texts), encoding="utf-8")
        draw({name: rows for name, rows in tables.items() if name != "dark"}, IMAGES / "perception_bound.png")
    return int(any("FAILS" in text for text in texts))


if __name__ == "__main__":
    sys.exit(main())
