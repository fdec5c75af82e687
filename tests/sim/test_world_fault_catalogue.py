"""Each fault of the world in each tier: it does what it says, only then says so, and leaves no trace."""

from __future__ import annotations

import math
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest

import sim_pybullet.faults as catalogue
from executive.faults import FaultSpec
from executive.types import Centres, Reason
from tests.sim.bench import SPEED_M_S, Bench

pytestmark = pytest.mark.sim

SPECS: dict[str, FaultSpec] = {s.name: s for s in (getattr(catalogue, n) for n in catalogue.__all__)}
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
    before = bench.devices.tracks.read().left_m
    bench.drive(0.05, 0.05, 20)
    return bench.devices.tracks.read().left_m - before


def run_on(bench: Bench) -> float:
    """What the left encoder counts in the 30 s after a drive [m]."""
    bench.drive(0.02, 0.02)
    before = bench.devices.tracks.read().left_m
    bench.advance(30)
    return bench.devices.tracks.read().left_m - before


def blocked(bench: Bench) -> float:
    """1 for a drive that ends BLOCKED."""
    outcome = bench.drive(0.04, 0.04)
    return float(outcome is not None and outcome.reason is Reason.BLOCKED)


def arm_swing(bench: Bench) -> float:
    """How far the arm comes of 15 degrees [rad]."""
    bench.finish(bench.devices.cabin.move(15 * DEG, 0.0))
    swung = bench.devices.cabin.read().arm_rad
    bench.finish(bench.devices.cabin.move(0.0, 0.0))
    return swung


def cabin_swing(bench: Bench) -> float:
    """How far the cabin comes of 15 degrees [rad]."""
    bench.finish(bench.devices.cabin.move(0.0, 15 * DEG))
    swung = bench.devices.cabin.read().cabin_rad
    bench.finish(bench.devices.cabin.move(0.0, 0.0))
    return swung


def pull_of_a_drive(bench: Bench) -> float:
    """The tether's pull after 60 mm away from the spool [N]."""
    bench.drive(0.06, 0.06)
    return bench.world.tether.tension_n


def tether_out(bench: Bench) -> float:
    """Tether out beyond what the way takes, after 20 mm [m]."""
    bench.drive(0.02, 0.02)
    return bench.devices.tether.read().length_m - bench.world.tether.way_m(bench.world.anchor())


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
    before = bench.devices.head.read()
    bench.point(10 * DEG, 5 * DEG)
    after = bench.devices.head.read()
    bench.point()
    return after.pan_rad - before.pan_rad


def tilt_of_a_move(bench: Bench) -> float:
    before = bench.devices.head.read()
    bench.point(10 * DEG, 5 * DEG)
    after = bench.devices.head.read()
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


@dataclass(frozen=True)
class Case:
    """A fault with parameters, what to measure, and by how much that must be otherwise under it."""

    measure: Callable[[Bench], float]
    least: float
    parameters: dict[str, Any] = field(default_factory=dict)
    noise: float | None = None
    world: dict[str, Any] = field(default_factory=dict)

    @property
    def back_within(self) -> float:
        """How near to normal it must come again: half of what must be otherwise, unless said."""
        return self.least / 2 if self.noise is None else self.noise


LEFT = {"side": "left"}
RISE = {"ahead": "350 mm", "height": "60 mm"}
HERE = {"ahead": "0 m", "radius": "1 m"}
CASES: dict[str, Case] = {
    "motor_dead": Case(counts_of_a_drive, 0.02, LEFT),
    "track_weak": Case(counts_of_a_drive, 0.01, LEFT | {"factor": "50 %"}),
    "motor_runaway": Case(run_on, 0.015, LEFT),
    "motor_reversed": Case(counts_of_a_drive, 0.05, LEFT),
    "track_jam": Case(blocked, 1.0, LEFT),
    "arm_locked": Case(arm_swing, 14 * DEG, noise=0.5 * DEG),
    "cabin_locked": Case(cabin_swing, 14 * DEG, noise=0.5 * DEG),
    "slip_burst": Case(advance_of_a_drive, 0.015, noise=0.003),
    "side_slope_drift": Case(slide_of_a_drive, 0.006, noise=0.002),
    "low_friction_patch": Case(turn_of_a_turn, 5 * DEG, HERE, noise=2 * DEG),
    "sand_trap": Case(advance_of_a_drive, 0.045, HERE | {"slip": "100 %"}, noise=0.003),
    "cabin_grounding": Case(load_on_tracks, 0.15, noise=0.1),
    "wrong_elevation_model": Case(height_of_a_drive, 0.004, RISE, noise=0.002),
    "tether_snag": Case(pull_of_a_drive, 1.0, noise=0.2),
    "tether_capstan": Case(pull_of_a_drive, 1.0, noise=0.2),
    "spool_jam": Case(pull_of_a_drive, 1.0, noise=0.2),
    "tether_short": Case(pull_of_a_drive, 1.0, {"left": "10 mm"}, noise=0.2),
    "tether_slack": Case(tether_out, 0.3, noise=0.1),
    "pan_locked": Case(pan_of_a_move, 9 * DEG),
    "tilt_locked": Case(tilt_of_a_move, 4 * DEG),
    "head_slow": Case(ticks_of_a_move, 10.0, noise=1.0),
    "head_offset": Case(column, 12.0, noise=3.0),
    "head_backlash": Case(column_by_side, 8.0, noise=4.0),
    "head_step_loss": Case(column_after_moves, 25.0, noise=5.0),
    "lander_settling": Case(row, 30.0, {"leans": "1 deg"}, noise=1.0),
    "image_blur": Case(sharpness, 0.3, {"sigma": 1.5}, noise=0.05),
    "head_vibration": Case(markers_found, 2.0, {"amplitude": "0.1 deg"}, noise=0.0),
    "led_off": Case(markers_found, 2.0, {"markers": [1, 3]}, noise=0.0),
    "led_dim": Case(markers_found, 1.0, {"marker": 2, "factor": "2 %"}, noise=0.0),
    "led_stuck_on": Case(markers_found, 1.0, {"marker": 2}, noise=0.0),
    "led_swapped": Case(place_of_marker_0, 10.0, {"markers": [0, 2]}, noise=1.0),
    "false_reflection": Case(place_of_marker_0, 10.0, {"strength": "200 %"}, noise=1.0),
    "marker_occluded": Case(markers_found, 1.0, {"marker": 0}, noise=0.0),
    "sun_moving": Case(light, 0.2, {"elevation": "-25 deg"}, noise=0.05),
    "cloud": Case(markers_found, 4.0, noise=0.0),
    "glare": Case(markers_found, 4.0, {"veil": "300 %"}, noise=0.0),
}
OF_THEIR_OWN = {"rock_on_path", "moving_rock"}  # they stay; tested below


@pytest.fixture
def bench_of() -> Iterator[Callable[..., Bench]]:
    made: list[Bench] = []

    def make(fault: str, tier: str = "geometric", /, **parameters: Any) -> Bench:
        made.append(Bench(fault, tier, parameters))
        return made[-1]

    yield make
    for bench in made:
        bench.close()


def test_every_fault_of_the_world_has_a_case() -> None:
    assert set(SPECS) == set(CASES) | OF_THEIR_OWN


@pytest.mark.parametrize(
    ("name", "tier"), [(n, t) for n, s in sorted(SPECS.items()) if n in CASES for t in s.tiers]
)
def test_it_acts_says_so_and_leaves_nothing_behind(
    name: str, tier: str, bench_of: Callable[..., Bench]
) -> None:
    case = CASES[name]
    bench = bench_of(name, tier, **case.parameters)
    normal = case.measure(bench)
    bench.set_level(1.0)
    assert not bench.fault.took_effect()  # nothing was done yet that it could have shown in
    under_it = case.measure(bench)
    assert abs(under_it - normal) >= case.least or math.isnan(under_it)
    assert bench.fault.took_effect()
    bench.set_level(0.0)
    assert case.measure(bench) == pytest.approx(normal, abs=case.back_within)


@pytest.mark.parametrize("name", sorted(n for n, s in SPECS.items() if s.graded))
def test_half_as_strong_acts_less(name: str, bench_of: Callable[..., Bench]) -> None:
    """The state that it sets, as the devices have it, lies between that of no level and of all of it."""
    bench = bench_of(name, "geometric", **CASES[name].parameters)
    states = []
    for level in (0.0, 0.5, 1.0):
        bench.set_level(level)
        bench.advance(15)
        states.append(_state(bench))
    nothing, half, all_of_it = states
    assert 0.0 < np.linalg.norm(half - nothing) < np.linalg.norm(all_of_it - nothing)


def _state(bench: Bench) -> Any:
    """Everything that graded faults alter, as numbers."""
    w = bench.world
    seeing = w.seeing
    at_x, at_y, _ = bench.position
    sun = seeing.sun
    return np.array(
        [
            *(m.speed_factor for m in w.tracks.motors),
            *(
                a
                for axis in (w.head.pan, w.head.tilt)
                for a in (axis.bias_rad, axis.play_rad, axis.rate_factor)
            ),
            *(v for lens in seeing.lenses for v in (lens.blur_px, lens.veil)),
            *seeing.lander_shift_m,
            *seeing.lander_turn_rad,
            seeing.clouds,
            seeing.daylight,
            0.0 if sun is None else sun.azimuth_rad - 1.9,
            w.head.sway_rad,
            w.extra_slip,
            w.side_drift,
            w.soils.at(float(at_x), float(at_y)).sinkage,
            0.0 if w.tether.bend is None else w.tether.bend.capstan,
            sum(rock.centre_site_m[2] + rock.radius_m for rock in w.rocks),
            *w.led_factor,
        ]
    )


@pytest.mark.parametrize("tier", ["full", "geometric"])
def test_a_rock_on_the_path_shows_once_it_is_met(tier: str, bench_of: Callable[..., Bench]) -> None:
    bench = bench_of("rock_on_path", tier, ahead="300 mm", radius="80 mm")
    bench.set_level(1.0)
    bench.drive(0.01, 0.01)
    assert not bench.fault.took_effect()
    bench.drive(0.3, 0.3)
    assert bench.fault.took_effect()
    assert bench.position[0] < 3.2


@pytest.mark.parametrize("tier", ["full", "geometric"])
def test_a_moving_rock_rolls_into_the_way(tier: str, bench_of: Callable[..., Bench]) -> None:
    bench = bench_of("moving_rock", tier, ahead="300 mm", from_aside="300 mm", speed="5 mm/s")
    bench.set_level(1.0)
    (start,) = bench.world.rocks[-1:]
    assert start.centre_site_m[:2] == pytest.approx((3.3, 0.3), abs=0.01)
    bench.advance(30)
    assert not bench.fault.took_effect()
    bench.advance(40)
    (rock,) = bench.world.rocks[-1:]
    assert abs(rock.centre_site_m[1]) < 0.02
    bench.drive(0.2, 0.2)
    assert bench.fault.took_effect()


def test_a_runaway_stops_with_the_next_drive(bench_of: Callable[..., Bench]) -> None:
    bench = bench_of("motor_runaway", side="right", lasts="60 s")
    bench.set_level(1.0)
    bench.devices.tracks.drive(0.05, 0.05, SPEED_M_S)
    bench.advance(5)
    bench.devices.tracks.stop()
    bench.advance(5)
    reading = bench.devices.tracks.read()
    assert reading.moving
    assert reading.right_m - reading.left_m == pytest.approx(5 * SPEED_M_S, rel=0.05)


def test_a_jammed_track_draws_more_than_the_other(bench_of: Callable[..., Bench]) -> None:
    bench = bench_of("track_jam", side="left")
    bench.set_level(1.0)
    bench.devices.tracks.drive(0.05, 0.05, SPEED_M_S)
    bench.advance(4)
    reading = bench.devices.tracks.read()
    assert reading.left_current_a > reading.right_current_a + 0.03


def test_a_snag_is_felt_in_part_at_the_spool_and_a_drag_round_a_rock_not_at_all(
    bench_of: Callable[..., Bench],
) -> None:
    for name, parameters, felt in (("tether_snag", {"felt": "50 %"}, 0.5), ("tether_capstan", {}, 0.0)):
        bench = bench_of(name, **parameters)
        bench.set_level(1.0)
        bench.drive(0.08, 0.08)
        pull = bench.world.tether.tension_n
        assert bench.devices.tether.read().tension_n / pull == pytest.approx(felt, abs=0.05)


def test_a_locked_head_ends_its_move_with_a_defect(bench_of: Callable[..., Bench]) -> None:
    bench = bench_of("pan_locked")
    bench.set_level(1.0)
    outcome = bench.point(10 * DEG)
    assert outcome is not None
    assert outcome.reason is Reason.DEVICE
    assert "pan" in outcome.detail


def test_an_occluded_marker_shows_again_from_another_side(bench_of: Callable[..., Bench]) -> None:
    bench = bench_of("marker_occluded", marker=0, size="20 mm", away="100 mm")
    bench.set_level(1.0)
    assert bench.found() == 3
    bench.drive(-0.10, 0.10)
    assert bench.found() == 4


def test_markers_are_told_one_way_only() -> None:
    for wrong in ({}, {"marker": 1, "markers": [1]}):
        with pytest.raises(ValueError, match="expected exactly one of them"):
            SPECS["led_off"].model.model_validate(wrong)


def test_the_catalogue_is_told_without_the_physics() -> None:
    code = "import sys, sim_pybullet.faults; sys.exit('pybullet' in sys.modules or 'cv2' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
