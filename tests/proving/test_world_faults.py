"""Faults of the simulated world: each does what it says, in both tiers where both offer it."""

import math

import numpy as np
import pytest

from executive.config.backends import BackendRequest
from executive.core import registry
from executive.core.devices import DRIVE
from executive.core.errors import LongarmError
from executive.core.ports import LocaliseRequest
from executive.core.rig import RigCalibration
from executive.core.types import (
    Point,
    PoseEstimate,
    PoseSource,
    Quality,
    Segment,
)
from executive.isc.attitude import quat_from_heading_tilt
from executive.run.fault import FAULT_KIND
from executive.testing.fake import FakeBackend, FakeWorld
from perception.localizer.localizer import LedStereoLocalizer
from sim_pybullet import BACKEND
from sim_pybullet.config import WorldConfig
from sim_pybullet.path import ahead_on
from tests.sim_pybullet.worlds import (
    AHEAD,
    heading,
    plain,
    travel,
)

pytestmark = pytest.mark.sim

CORNER = (
    Segment(Point(3.0, 0.0), Point(4.0, 0.0), 0.03, 0.25, 0.03, 0),
    Segment(Point(4.0, 0.0), Point(4.0, 1.0), 0.03, 0.25, 0.03, 1),
)


def make(name, **parameters):
    spec = registry.get(FAULT_KIND, name)
    return spec.make(spec.model.model_validate(parameters))


@pytest.fixture
def backend_of():
    made = []

    def make_backend(tier="geometric", **world):
        config = WorldConfig.model_validate(plain(**world))
        made.append(BACKEND.create(BackendRequest(config, AHEAD, 3, tier, RigCalibration(), None, 1.0)))
        return made[-1]

    yield make_backend
    for backend in made:
        backend.close()


def finish(backend, action):
    while (outcome := action.poll()) is None:
        backend.advance()
    return outcome


def markers_found(backend, localizer):
    """How many markers a precise localisation of the rover where it stands rests on."""
    position, _ = backend.world.body.pose()
    covariance = np.diag([0.02**2] * 3 + [0.05**2] * 3)
    quat = quat_from_heading_tilt(0.0, 0.0, 0.0)
    prior = PoseEstimate(backend.clock.now_s, tuple(position), quat, covariance, PoseSource.PRIOR)
    fix = finish(backend, localizer.locate(LocaliseRequest(Quality.PRECISE, prior)))
    assert fix.ok, fix
    return fix.value.pose.markers


@pytest.mark.parametrize("tier", ["full", "geometric"])
def test_a_marker_that_is_off_is_not_seen_until_it_is_back(backend_of, tier):
    backend, fault = backend_of(tier), make("led_off", marker=2)
    localizer = LedStereoLocalizer(backend.devices, backend.rig, backend.clock)
    assert markers_found(backend, localizer) == 4
    fault.apply(backend, True)
    assert markers_found(backend, localizer) == 3
    fault.apply(backend, False)
    assert markers_found(backend, localizer) == 4


def test_a_dim_marker_emits_its_share(backend_of):
    backend, fault = backend_of(), make("led_dim", marker=0, factor="25 %")
    fault.apply(backend, True)
    assert backend.world.scene().led_factor == (0.25, 1.0, 1.0, 1.0)
    fault.apply(backend, False)
    assert backend.world.scene().led_factor == (1.0, 1.0, 1.0, 1.0)


def test_a_slip_burst_takes_its_share_of_the_travel(backend_of):
    backend, fault = backend_of(), make("slip_burst", slip="40 %")
    driven = []
    for active in (False, True, False):
        fault.apply(backend, active)
        before = backend.world.body.pose()[0].copy()
        finish(backend, backend.devices[DRIVE].drive(0.1, 0.1, 0.0014))
        driven.append(travel(before, backend.world.body.pose()[0]))
    assert driven[1] / driven[0] == pytest.approx(0.6, abs=0.03)
    assert driven[2] / driven[0] == pytest.approx(1.0, abs=0.03)


def test_a_weak_track_lags_and_its_encoder_says_so(backend_of):
    backend, fault = backend_of(), make("track_weak", side="left", factor="50 %")
    fault.apply(backend, True)
    before = heading(backend.world.body.pose()[1])
    backend.devices[DRIVE].drive(0.1, 0.1, 0.0014)
    for _ in range(60):
        backend.advance()
    reading = backend.devices[DRIVE].read()
    assert reading.left_m / reading.right_m == pytest.approx(0.5, abs=0.02)
    assert heading(backend.world.body.pose()[1]) - before > math.radians(5.0)


def test_a_rock_on_the_path_stops_the_rover(backend_of):
    backend, fault = backend_of(), make("rock_on_path", ahead="300 mm", radius="80 mm")
    fault.apply(backend, True)
    (rock,) = backend.world.rocks[-1:]
    assert rock.centre_site_m[:2] == pytest.approx((3.3, 0.0), abs=0.01)
    finish(backend, backend.devices[DRIVE].drive(0.3, 0.3, 0.0014))
    position, _ = backend.world.body.pose()
    assert position[0] < 3.2


def test_ahead_on_the_path_goes_round_its_corners():
    assert ahead_on(CORNER, (3.5, 0.1), 0.2) == pytest.approx((3.7, 0.0))
    assert ahead_on(CORNER, (3.5, 0.1), 0.7) == pytest.approx((4.0, 0.2))
    assert ahead_on(CORNER, (3.99, 0.01), 0.3) == pytest.approx((4.0, 0.31))
    assert ahead_on(CORNER, (4.0, 0.5), 0.2, aside_m=0.1) == pytest.approx((3.9, 0.7))
    assert ahead_on(CORNER, (4.0, 0.9), 0.5) == pytest.approx((4.0, 1.4))


def test_a_fault_of_the_simulation_refuses_another_backend():
    robot = FakeBackend(BackendRequest(FakeWorld(), AHEAD, 1, "geometric", RigCalibration(), None, 1.0))
    with pytest.raises(LongarmError, match="got a backend of type FakeBackend"):
        make("led_off", marker=0).apply(robot, True)
