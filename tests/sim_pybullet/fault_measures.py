"""What a fault of the world makes otherwise: one number each, measured on a bench through ports and truth."""

from __future__ import annotations

import math

import numpy as np

from executive.core.devices import CABIN, DRIVE, HEAD, TETHER
from executive.core.types import Centres, Reason
from tests.sim_pybullet.bench import Bench

DEG = math.radians(1.0)


def advance_of_a_drive(bench: Bench) -> float:
    """Metres ahead for 50 mm of belt."""
    before = bench.position
    bench.drive(0.05, 0.05, 60)
    return float(np.linalg.norm(bench.position - before))


def slide_of_a_drive(bench: Bench) -> float:
    """Metres to the left for 50 mm of belt."""
    before, heading = bench.position, bench.heading
    bench.drive(0.05, 0.05)
    dx, dy, _ = bench.position - before
    return float(-math.sin(heading) * dx + math.cos(heading) * dy)


def turn_of_a_turn(bench: Bench) -> float:
    """Radians for 30 mm of belt each way; turned back after."""
    before = bench.heading
    bench.drive(-0.03, 0.03)
    turned = bench.heading - before
    bench.drive(0.03, -0.03)
    return turned


def counts_of_a_drive(bench: Bench) -> float:
    """What the left encoder has counted 20 s into a drive [m]."""
    before = bench.devices[DRIVE].read().left_m
    bench.drive(0.05, 0.05, 20)
    return bench.devices[DRIVE].read().left_m - before


def run_on(bench: Bench) -> float:
    """What the left encoder counts in the 30 s after a drive [m]."""
    bench.drive(0.02, 0.02)
    before = bench.devices[DRIVE].read().left_m
    bench.advance(30)
    return bench.devices[DRIVE].read().left_m - before


def blocked(bench: Bench) -> float:
    """1 for a drive that ends BLOCKED."""
    outcome = bench.drive(0.04, 0.04)
    return float(outcome is not None and outcome.reason is Reason.BLOCKED)


def arm_swing(bench: Bench) -> float:
    """How far the arm comes of 15 degrees [rad]."""
    bench.finish(bench.devices[CABIN].move(15 * DEG, 0.0))
    swung = bench.devices[CABIN].read().arm_rad
    bench.finish(bench.devices[CABIN].move(0.0, 0.0))
    return swung


def cabin_swing(bench: Bench) -> float:
    """How far the cabin comes of 15 degrees [rad]."""
    bench.finish(bench.devices[CABIN].move(0.0, 15 * DEG))
    swung = bench.devices[CABIN].read().cabin_rad
    bench.finish(bench.devices[CABIN].move(0.0, 0.0))
    return swung


def pull_of_a_drive(bench: Bench) -> float:
    """The tether's pull after 60 mm away from the spool [N]."""
    bench.drive(0.06, 0.06)
    return bench.world.tether.tension_n


def tether_out(bench: Bench) -> float:
    """Tether out beyond what the way takes, after 20 mm [m]."""
    bench.drive(0.02, 0.02)
    return bench.devices[TETHER].read().length_m - bench.world.tether.way_m(bench.world.anchor())


def load_on_tracks(bench: Bench) -> float:
    """Share of the weight that the tracks bear, a minute on."""
    bench.advance(60)
    return sum(bench.world.body.loads()) / bench.world.weight_n


def height_of_a_drive(bench: Bench) -> float:
    """How much higher the rover stands after 50 mm [m]."""
    bench.advance(5)
    before = bench.position[2]
    bench.drive(0.05, 0.05)
    return float(bench.position[2] - before)


def pan_of_a_move(bench: Bench) -> float:
    """How far the pan encoder comes of 10 degrees, and the tilt encoder of 5 [rad]; pointed back after."""
    before = bench.devices[HEAD].read()
    bench.point(10 * DEG, 5 * DEG)
    after = bench.devices[HEAD].read()
    bench.point()
    return after.pan_rad - before.pan_rad


def tilt_of_a_move(bench: Bench) -> float:
    before = bench.devices[HEAD].read()
    bench.point(10 * DEG, 5 * DEG)
    after = bench.devices[HEAD].read()
    bench.point()
    return after.tilt_rad - before.tilt_rad


def ticks_of_a_move(bench: Bench) -> float:
    began = bench.backend.clock.ticks
    bench.point(10 * DEG)
    took = bench.backend.clock.ticks - began
    bench.point()
    return float(took)


def column(bench: Bench) -> float:
    """The column of the markers' middle in the left image [px]."""
    return float(np.mean(bench.centres()[0, :, 0]))


def row(bench: Bench) -> float:
    """The row of the markers' middle in the left image [px]."""
    return float(np.mean(bench.centres()[0, :, 1]))


def column_after_moves(bench: Bench) -> float:
    """The same after three moves there and back."""
    for _ in range(3):
        bench.point(8 * DEG)
        bench.point()
    return column(bench)


def column_by_side(bench: Bench) -> float:
    """How the column differs with the side from which the head has come [px]."""
    bench.point(3 * DEG)
    bench.point()
    from_the_left = column(bench)
    bench.point(-3 * DEG)
    bench.point()
    return column(bench) - from_the_left


def place_of_marker_0(bench: Bench) -> float:
    """The column of marker 0 in the left image [px]."""
    return float(bench.centres()[0, 0, 0])


def markers_found(bench: Bench) -> float:
    return float(bench.found())


def sharpness(bench: Bench) -> float:
    """Logarithm of found markers' reported error, or of the contrast of neighbouring pixels of an image."""
    value = bench.shot()
    if isinstance(value, Centres):
        return float(np.log(np.nanmean(value.sigma_px)))
    return float(np.log(np.abs(np.diff(value.counts[0][0].astype(float), axis=1)).mean()))


def light(bench: Bench) -> float:
    """Logarithm of images' mean counts, or of centres' reported error, which grows with the daylight."""
    value = bench.shot()
    return float(np.log(np.nanmean(value.sigma_px if isinstance(value, Centres) else value.counts[0])))
