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
from executive.core.devices import DRIVE, TETHER
from executive.core.types import Reason
from executive.run.fault import FaultSpec
from tests.sim_pybullet import fault_measures as measure
from tests.sim_pybullet.bench import SPEED_M_S, Bench
from tests.sim_pybullet.fault_measures import DEG

pytestmark = pytest.mark.sim

SPECS: dict[str, FaultSpec] = {s.name: s for s in (getattr(catalogue, n) for n in catalogue.__all__)}


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
    "motor_dead": Case(measure.counts_of_a_drive, 0.02, LEFT),
    "track_weak": Case(measure.counts_of_a_drive, 0.01, LEFT | {"factor": "50 %"}),
    "motor_runaway": Case(measure.run_on, 0.015, LEFT),
    "motor_reversed": Case(measure.counts_of_a_drive, 0.05, LEFT),
    "track_jam": Case(measure.blocked, 1.0, LEFT),
    "arm_locked": Case(measure.arm_swing, 14 * DEG, noise=0.5 * DEG),
    "cabin_locked": Case(measure.cabin_swing, 14 * DEG, noise=0.5 * DEG),
    "slip_burst": Case(measure.advance_of_a_drive, 0.015, noise=0.003),
    "side_slope_drift": Case(measure.slide_of_a_drive, 0.006, noise=0.002),
    "low_friction_patch": Case(measure.turn_of_a_turn, 5 * DEG, HERE, noise=2 * DEG),
    "sand_trap": Case(measure.advance_of_a_drive, 0.045, HERE | {"slip": "100 %"}, noise=0.003),
    "cabin_grounding": Case(measure.load_on_tracks, 0.15, noise=0.1),
    "wrong_elevation_model": Case(measure.height_of_a_drive, 0.004, RISE, noise=0.002),
    "tether_snag": Case(measure.pull_of_a_drive, 1.0, noise=0.2),
    "tether_capstan": Case(measure.pull_of_a_drive, 1.0, noise=0.2),
    "spool_jam": Case(measure.pull_of_a_drive, 1.0, noise=0.2),
    "tether_short": Case(measure.pull_of_a_drive, 1.0, {"left": "10 mm"}, noise=0.2),
    "tether_slack": Case(measure.tether_out, 0.3, noise=0.1),
    "pan_locked": Case(measure.pan_of_a_move, 9 * DEG),
    "tilt_locked": Case(measure.tilt_of_a_move, 4 * DEG),
    "head_slow": Case(measure.ticks_of_a_move, 10.0, noise=1.0),
    "head_offset": Case(measure.column, 12.0, noise=3.0),
    "head_backlash": Case(measure.column_by_side, 8.0, noise=4.0),
    "head_step_loss": Case(measure.column_after_moves, 25.0, noise=5.0),
    "lander_settling": Case(measure.row, 30.0, {"leans": "1 deg"}, noise=1.0),
    "image_blur": Case(measure.sharpness, 0.3, {"sigma": 1.5}, noise=0.05),
    "head_vibration": Case(measure.markers_found, 2.0, {"amplitude": "0.1 deg"}, noise=0.0),
    "led_off": Case(measure.markers_found, 2.0, {"markers": [1, 3]}, noise=0.0),
    "led_dim": Case(measure.markers_found, 1.0, {"marker": 2, "factor": "2 %"}, noise=0.0),
    "led_stuck_on": Case(measure.markers_found, 1.0, {"marker": 2}, noise=0.0),
    "led_swapped": Case(measure.place_of_marker_0, 10.0, {"markers": [0, 2]}, noise=1.0),
    "false_reflection": Case(measure.place_of_marker_0, 10.0, {"strength": "200 %"}, noise=1.0),
    "marker_occluded": Case(measure.markers_found, 1.0, {"marker": 0}, noise=0.0),
    "sun_moving": Case(measure.light, 0.2, {"elevation": "-25 deg"}, noise=0.05),
    "cloud": Case(measure.markers_found, 4.0, noise=0.0),
    "glare": Case(measure.markers_found, 4.0, {"veil": "300 %"}, noise=0.0),
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
    (placed,) = bench.fault.placed()
    assert (placed.kind, placed.radius_m) == ("rock", 0.08)
    assert (placed.x_m, placed.y_m) == pytest.approx((3.3, 0.0), abs=0.01)
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
    bench.devices[DRIVE].drive(0.05, 0.05, SPEED_M_S)
    bench.advance(5)
    bench.devices[DRIVE].stop()
    bench.advance(5)
    reading = bench.devices[DRIVE].read()
    assert reading.moving
    assert reading.right_m - reading.left_m == pytest.approx(5 * SPEED_M_S, rel=0.05)


def test_a_jammed_track_draws_more_than_the_other(bench_of: Callable[..., Bench]) -> None:
    bench = bench_of("track_jam", side="left")
    bench.set_level(1.0)
    bench.devices[DRIVE].drive(0.05, 0.05, SPEED_M_S)
    bench.advance(4)
    reading = bench.devices[DRIVE].read()
    assert reading.left_current_a > reading.right_current_a + 0.03


def test_a_snag_is_felt_in_part_at_the_spool_and_a_drag_round_a_rock_not_at_all(
    bench_of: Callable[..., Bench],
) -> None:
    for name, parameters, felt in (("tether_snag", {"felt": "50 %"}, 0.5), ("tether_capstan", {}, 0.0)):
        bench = bench_of(name, **parameters)
        bench.set_level(1.0)
        bench.drive(0.08, 0.08)
        pull = bench.world.tether.tension_n
        assert bench.devices[TETHER].read().tension_n / pull == pytest.approx(felt, abs=0.05)


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
