"""What watching the ground tells of the head, measured in both tiers: errors and refusals.

    python -m benchmarks.head_watch [--trials N]

Each trial takes a reference picture of procedural ground, moves the head's frame by a planted rotation and
shift, changes the light, takes another picture and asks `head.alignment`. The head points as well as
it does. NEES is the mean squared error in units of the reported covariance, 8 if that is true.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from executive.core.rig import RigCalibration
from executive.core.types import (
    Centres,
    HeadReading,
    Images,
    Shot,
)
from perception.geometry.chain import Chain
from perception.head.alignment import Alignment, align
from perception.head.head_watch import DOWN_RAD
from perception.head.registration import matched
from sim_pybullet.geometric import CentreDeveloper
from sim_pybullet.ground_marks import SIGMA_PX
from sim_pybullet.imaging import ImageDeveloper
from sim_pybullet.leds import MarkerOptics
from sim_pybullet.picture import Picture
from sim_pybullet.procedural import Relief, make_ground
from sim_pybullet.radiometry import Exposure, calibrated_light
from sim_pybullet.raycast import HeightField
from sim_pybullet.scene import SceneState
from sim_pybullet.seeing import CLEAR, Lens, Seeing
from sim_pybullet.sunlight import Sun

RIG = RigCalibration()
CHAIN = Chain.of(RIG)
SUN = Sun()
ROVER_M = np.array([3.0, 0.0, 0.065])


@dataclass(frozen=True)
class Case:
    """What is done to the head [deg, m], and to what it sees; `moved` is the standard deviation."""

    name: str
    turned_deg: float = 0.0
    shifted_m: float = 0.0
    seeing: Callable[[], Seeing] = lambda: CLEAR
    elsewhere: bool = False


def lit(sun: Sun, **changes: object) -> Seeing:
    return replace(CLEAR, sun=sun, daylight=sun.daylight(SUN), **changes)


def sun_moved(elevation_deg: float, azimuth_deg: float) -> Sun:
    return Sun(SUN.elevation_rad + math.radians(elevation_deg), SUN.azimuth_rad + math.radians(azimuth_deg))


CASES = (
    Case("nothing"),
    Case("turned 0.3 deg", 0.3),
    Case("turned 2 deg", 2.0),
    Case("shifted 20 mm", 0.0, 0.02),
    Case("turned 0.3 deg, cloud (30 % light)", 0.3, 0.0, lambda: replace(CLEAR, clouds=0.3)),
    Case("turned 0.3 deg, sun 10 deg on", 0.3, 0.0, lambda: lit(sun_moved(-4, 10))),
    Case("turned 0.3 deg, sun 40 deg on, 25 down", 0.3, 0.0, lambda: lit(sun_moved(-25, 40))),
    Case("turned 0.3 deg, dust (2 px blur)", 0.3, 0.0, lambda: replace(CLEAR, lenses=(Lens(2.0), Lens(2.0)))),
    Case("another place", elsewhere=True),
)


def scene(seeing: Seeing, pan_rad: float, tilt_rad: float) -> SceneState:
    T = np.eye(4)
    T[:3, 3] = ROVER_M
    return SceneState(0.0, T, T, T, T, 0.0, 0.0, pan_rad, tilt_rad, seeing=seeing)


def developers(seed: int) -> dict[str, Callable[[], ImageDeveloper | CentreDeveloper]]:
    """Both tiers over the same ground."""
    terrain = make_ground(Relief(0.008, 3, 0.0, 0.0), (-2.0, -6.0), 12.0, 0.03, np.random.default_rng(seed))
    field, rng = HeightField(terrain), np.random.default_rng(seed)
    optics = MarkerOptics(RIG, calibrated_light(RIG), field)
    return {
        "full": lambda: ImageDeveloper(Picture(RIG, terrain, SUN, rng), rng),
        "geometric": lambda: CentreDeveloper(optics, Exposure(RIG.sensor.bits), field, rng),
    }


def trial(
    developer: ImageDeveloper | CentreDeveloper, case: Case, rng: np.random.Generator
) -> tuple[Alignment | str, np.ndarray, float]:
    """What is found, what was planted (8,), and the patches' rest where nothing moved [px]."""
    pan = math.radians(rng.uniform(18, 30) * rng.choice((-1, 1)))
    said = HeadReading(0.0, pan, DOWN_RAD, False)
    missed = (RIG.head.pan_accuracy_rad, RIG.head.tilt_accuracy_rad)
    planted = np.zeros(8)
    planted[:3] = np.radians(case.turned_deg) * rng.standard_normal(3) / math.sqrt(3)
    planted[3:6] = case.shifted_m * rng.standard_normal(3) / math.sqrt(3)

    def take(seeing: Seeing, aside_rad: float = 0.0) -> Images | Centres:
        off = rng.uniform(-1, 1, 2) * missed
        true = scene(seeing, pan + aside_rad + off[0], DOWN_RAD + off[1])
        return developer.develop(Shot((0,)), (true,), said, 0.0)

    before = take(CLEAR)
    # The lander turns about the mast's foot, the alignment is about the head: the mast's top moves as well.
    mast = np.array([0.0, 0.0, RIG.head.mast_height_m])
    shift = planted[3:6] - np.cross(planted[:3], mast)
    seeing = replace(case.seeing(), lander_turn_rad=tuple(planted[:3]), lander_shift_m=tuple(shift))
    after = take(seeing, math.radians(60) if case.elsewhere else 0.0)
    spread = math.nan
    if case.name == "nothing":
        left, _ = matched(before, after, RIG.sensor.noise_counts)
        moved = left.after_px - left.before_px
        spread = float((moved - _smooth(left.before_px, moved)).std())
    return align(CHAIN, before, after), planted, spread


def _smooth(at: np.ndarray, moved: np.ndarray) -> np.ndarray:
    """What a quadratic surface over the picture makes of the motion: all but the registration's error."""
    u, v = (at - 512).T / 512
    A = np.stack([np.ones_like(u), u, v, u * u, u * v, v * v], axis=1)
    return A @ np.linalg.lstsq(A, moved, rcond=None)[0]


def row(name: str, results: list[tuple[Alignment | str, np.ndarray, float]]) -> str:
    known = [(a, p) for a, p, _ in results if isinstance(a, Alignment)]
    if not known:
        return f"{name:42s} known   0 %"
    off = np.array([a.mean - p for a, p in known])
    nees = np.mean([o @ np.linalg.solve(a.covariance, o) for o, (a, _) in zip(off, known, strict=True)])
    turn = np.sqrt((np.degrees(off[:, :3]) ** 2).mean(axis=0))
    shift = 1e3 * math.sqrt((off[:, 3:6] ** 2).sum(axis=1).mean())
    apart = math.degrees(math.sqrt((off[:, 6] ** 2).mean()))
    x, y, z = turn
    return (
        f"{name:42s} known {len(known) / len(results):4.0%}  rms x {x:.3f} y {y:.3f} z {z:.3f} deg"
        f"  shift {shift:4.1f} mm  cameras {apart:.4f} deg  NEES {nees:5.1f}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--trials", type=int, default=100)
    parser.add_argument("--tiers", nargs="+", default=["full", "geometric"])
    trials = parser.parse_args().trials
    for tier in parser.parse_args().tiers:
        print(f"{tier} tier, {trials} trials a row; sigma of a landmark there {SIGMA_PX} px")
        for case in CASES:
            rng = np.random.default_rng(7)
            results = []
            for i in range(trials):
                if i % 10 == 0:
                    developer = developers(100 + i)[tier]()
                results.append(trial(developer, case, rng))
            print(row(case.name, results))
            spreads = [s for *_, s in results if math.isfinite(s)]
            if spreads:
                print(f"{'':42s} a patch is off by {np.median(spreads):.3f} px rms an axis, median")


if __name__ == "__main__":
    main()
