"""In-situ classification over a robot of arithmetic: what was done to it is what it concludes."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import pytest

from executive.config.backends import BackendRequest
from executive.core.devices import DRIVE, TETHER
from executive.core.rig import RigCalibration
from executive.core.types import (
    Outcome,
    Point,
    PoseEstimate,
    Reason,
    Segment,
)
from executive.isc import (
    Assessment,
    Classification,
    Readings,
    correction,
    known_channels,
    known_hypotheses,
)
from executive.isc.motion import ADVANCE, YAW_EFFICIENCY
from executive.testing import FakeBackend, FakeWorld
from tests.executive.isc.test_prediction import pose

SEGMENT = Segment(Point(2.0, 0.0), Point(3.0, 0.0), 0.03, 0.25, 0.03)
GAUGE_M = RigCalibration().rover.track_gauge_m


@dataclass
class Bench:
    """A fake robot, its classification, and its true pose as a fix."""

    backend: FakeBackend
    mind: Classification

    def drive(self, left_m: float, right_m: float) -> None:
        action = self.backend.devices[DRIVE].drive(left_m, right_m, 0.0014)
        while action.poll() is None:
            self.mind.tracker.sense(self.backend.devices)
            self.backend.advance()
        self.mind.tracker.sense(self.backend.devices)

    def pull(self, tension_n: float) -> None:
        """Let the tether be felt like this."""
        tether = replace(self.backend.devices[TETHER].read(), tension_n=tension_n)
        sensed = self.mind.tracker.sense(self.backend.devices)
        readings = Readings({**sensed.readings.by_device, TETHER.name: tether})
        self.mind.tracker.sensed = replace(sensed, tether=tether, readings=readings)

    def fix(self, markers: int = 4) -> PoseEstimate:
        robot = self.backend.robot
        seen = pose(robot.x_m, robot.y_m, robot.heading_rad)
        return replace(seen, time_s=self.backend.clock.now_s, markers=markers)

    def turn(self, angle_rad: float) -> Assessment:
        rotation = angle_rad / self.mind.motion.yaw_efficiency
        self.drive(-rotation * GAUGE_M / 2, rotation * GAUGE_M / 2)
        return self.mind.on_fix(self.fix())

    def advance(self, distance_m: float) -> Assessment:
        travel = distance_m / self.mind.motion.advance
        self.drive(travel, travel)
        return self.mind.on_fix(self.fix())


def classification(backend: FakeBackend, markers_expected: int = 4) -> Classification:
    """One that weighs all that is registered, and keeps what it announces in `heard`."""
    heard: list[Assessment] = []
    made = Classification(
        pose(2.0, 0.0, 0.0, 0.05, 0.3),
        backend.rig,
        backend.clock,
        known_hypotheses(),
        known_channels(),
        heard.append,
        markers_expected,
    )
    made.heard = heard
    return made


@pytest.fixture
def bench() -> Bench:
    request = BackendRequest(FakeWorld(), (SEGMENT,), 1, "geometric", RigCalibration(), None, 1.0)
    backend = FakeBackend(request)
    mind = classification(backend)
    made = Bench(backend, mind)
    mind.tracker.sense(backend.devices)
    mind.on_fix(made.fix())
    for _ in range(4):
        made.turn(0.3)
        made.advance(0.1)
    return made


def change_soil(bench: Bench, **changed: float) -> None:
    bench.backend.robot.world = bench.backend.robot.world.model_copy(update=changed)


def test_known_soil_stays_nominal(bench: Bench) -> None:
    assert bench.turn(0.4).likeliest == "nominal"
    assert bench.advance(0.1).weights["nominal"] > 0.85


def test_soil_that_turns_half_as_much_is_turning_slip(bench: Bench) -> None:
    change_soil(bench, yaw_efficiency=0.25)
    assert bench.turn(0.5).anomaly[0] == "slip_turning"
    assert bench.mind.observed_turn_ratio == pytest.approx(0.25 / 0.6, abs=0.05)


def test_half_the_advance_is_longitudinal_slip(bench: Bench) -> None:
    change_soil(bench, advance=0.5)
    bench.advance(0.1)
    assert bench.advance(0.1).anomaly[0] == "slip_longitudinal"


def test_no_advance_at_a_high_current_is_an_obstacle(bench: Bench) -> None:
    change_soil(bench, advance=0.0, drive_current_a=0.30)
    assert bench.advance(0.1).anomaly[0] == "stuck_on_obstacle"


def test_a_missing_marker_is_noticed(bench: Bench) -> None:
    for _ in range(2):
        found = bench.mind.on_fix(bench.fix(markers=3))
    assert found.anomaly[0] == "marker_lost"


@pytest.mark.parametrize(
    ("reason", "hypothesis"),
    [
        (Reason.UNSTABLE_IMAGES, "illumination_change"),
        (Reason.IMPLAUSIBLE, "localisation_outlier"),
        (Reason.OVERSHOOT, "overshoot"),
        (Reason.TETHER, "tether_snag"),
        (Reason.TILT, "tilt_risk"),
    ],
)
def test_a_failure_speaks_for_its_hypothesis(bench: Bench, reason: Reason, hypothesis: str) -> None:
    if reason is Reason.TETHER:
        bench.pull(5.0)
    assert bench.mind.on_failure(Outcome(reason)).anomaly[0] == hypothesis


def test_a_pull_that_nobody_feels_is_no_snag(bench: Bench) -> None:
    assert bench.mind.on_failure(Outcome(Reason.TETHER)).anomaly[0] != "tether_snag"


def test_what_is_not_explained_teaches_nothing(bench: Bench) -> None:
    change_soil(bench, advance=0.0)
    learnt = bench.mind.motion.advance
    for _ in range(2):
        bench.advance(0.1)
    assert bench.mind.motion.advance == learnt
    assert bench.mind.predicted().x_m == pytest.approx(bench.backend.robot.x_m)


def test_adopting_a_ratio_makes_the_next_turn_right(bench: Bench) -> None:
    change_soil(bench, yaw_efficiency=0.25)
    bench.turn(0.5)
    bench.mind.tracker.reset_parameter(YAW_EFFICIENCY, bench.mind.observed_turn_ratio or 1.0, 0.3)
    bench.mind.settle()
    before = bench.backend.robot.heading_rad
    bench.turn(0.5)
    assert bench.backend.robot.heading_rad - before == pytest.approx(0.5, rel=0.1)
    assert bench.mind.weights["nominal"] > 0.5


def test_extrapolation_gives_the_time_to_the_off_track_margin(bench: Bench) -> None:
    bench.mind.tracker.motion = correction.reset_parameter(bench.mind.motion, ADVANCE, 1.0, 0.01)
    assessment = bench.mind.extrapolate(pose(2.5, 0.10, math.radians(30.0)), SEGMENT)
    assert assessment.time_to_margin_s == pytest.approx((0.25 - 0.10) / (0.0014 * math.sin(math.radians(30))))
    assert bench.mind.extrapolate(pose(2.5, 0.10, 0.0), SEGMENT).time_to_margin_s is None


def test_a_blocked_drive_inflates_along_its_way(bench: Bench) -> None:
    bench.drive(0.1, 0.1)
    before = bench.mind.predicted()
    bench.mind.on_failure(Outcome(Reason.BLOCKED))
    doubted = bench.mind.predicted()
    c, s = math.cos(doubted.heading_rad), math.sin(doubted.heading_rad)
    ahead = Segment(Point(0.0, 0.0), Point(c, s), 0.03, 0.25, 0.03)
    aside = Segment(Point(0.0, 0.0), Point(-s, c), 0.03, 0.25, 0.03)
    assert doubted.sigma_across_m(aside) == pytest.approx(0.1 * bench.mind.motion.advance, rel=0.1)
    assert doubted.sigma_across_m(ahead) < before.sigma_across_m(ahead) + 0.02


def test_a_fix_after_inflation_still_tells_that_the_rover_is_stuck(bench: Bench) -> None:
    for _ in range(3):
        bench.advance(0.1)
    at = bench.fix()
    bench.drive(0.1, 0.1)  # the belts turn, yet the rover is seen where it was
    bench.mind.tracker.inflate(0.15, 0.15, math.radians(20.0))
    stuck = bench.mind.on_fix(replace(at, time_s=bench.backend.clock.now_s))
    assert stuck.likeliest == "stuck_on_obstacle"
    assert stuck.weights["localisation_outlier"] == 0.0


def test_a_marker_less_is_told_but_does_not_keep_the_model_from_learning(bench: Bench) -> None:
    for _ in range(4):
        travel = 0.1
        bench.drive(travel, travel)
        lost = bench.mind.on_fix(bench.fix(markers=3))
    assert lost.likeliest == "marker_lost"
    assert bench.mind.motion.advance == pytest.approx(0.95, abs=0.01)
    assert math.sqrt(bench.mind.motion.covariance[3, 3]) < 0.05  # it began at 0.06 and grows with travel


@pytest.mark.parametrize(("expected", "seen"), [(3, 3), (0, 0), (1, 1), (7, 7)])
def test_a_fix_on_all_markers_expected_stays_nominal(bench: Bench, expected: int, seen: int) -> None:
    bench.mind = classification(bench.backend, expected)
    for _ in range(5):
        found = bench.mind.on_fix(bench.fix(markers=seen))
    assert found.weights["nominal"] > 0.8
    assert found.weights["marker_lost"] < 0.05


def test_one_of_three_markers_missing_is_noticed(bench: Bench) -> None:
    bench.mind = classification(bench.backend, markers_expected=3)
    for _ in range(2):
        found = bench.mind.on_fix(bench.fix(markers=2))
    assert found.anomaly[0] == "marker_lost"


def test_fixes_failures_and_extrapolations_are_announced_in_order(bench: Bench) -> None:
    bench.mind = classification(bench.backend)
    told = [
        bench.mind.on_fix(bench.fix()),
        bench.mind.on_failure(Outcome(Reason.BLOCKED)),
        bench.mind.extrapolate(pose(2.5, 0.1, 0.3), SEGMENT),
    ]
    bench.mind.assess()
    assert bench.mind.heard == told
