"""Faults of estimation, on the fake robot's localizer."""

import math

import numpy as np
import pytest

from executive.core.devices import INCLINOMETER
from executive.core.ports import LocaliseRequest
from executive.core.types import PoseEstimate, PoseSource, Quality
from executive.testing import OverheadLocalizer
from proving.faults.estimation import (
    Bias,
    InclinometerBias,
    PoseNan,
    PoseOutlier,
    PoseStale,
    Shift,
    Staleness,
)
from proving.faults.parameters import Nothing

ANYWHERE = PoseEstimate(0.0, (3.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), np.eye(6), PoseSource.PRIOR)


@pytest.fixture
def locate(bench):
    """What is found behind a fault, time after time."""

    def behind(fault):
        robot = bench.robot
        localizer = fault.wrap_localizer(OverheadLocalizer(robot.devices, robot.rig, robot.clock), bench.cue)
        request = LocaliseRequest(Quality.PRECISE, ANYWHERE)
        return lambda: bench.finish(localizer.locate(request)).value.pose

    return behind


def test_an_outlier_is_shifted_and_as_sure_as_before(bench, locate):
    fault = PoseOutlier(Shift(x="0.3 m", y="-0.1 m"))
    find = locate(fault)
    bench.level.now = 0.0
    true = find()
    assert not fault.took_effect()
    bench.level.now = 0.5
    false = find()
    assert (false.x_m - true.x_m, false.y_m - true.y_m) == pytest.approx((0.15, -0.05), abs=0.002)
    assert (false.covariance == true.covariance).all()
    assert fault.took_effect()


def test_a_pose_that_is_no_number_has_none(locate):
    fault = PoseNan(Nothing())
    assert all(math.isnan(number) for number in locate(fault)().position_site_m)
    assert fault.took_effect()


@pytest.mark.parametrize("restamped", [False, True])
def test_a_stale_pose_is_the_last_one_before_the_onset(bench, locate, restamped):
    fault = PoseStale(Staleness(restamped=restamped))
    find = locate(fault)
    bench.level.now = 0.0
    last = find()
    bench.level.now = 1.0
    bench.robot.robot.move(0.2, 0.2)
    old = find()
    assert old.position_site_m == last.position_site_m
    assert (old.time_s > last.time_s) == restamped
    assert fault.took_effect()
    bench.level.now = 0.0
    assert find().x_m > last.x_m + 0.1


def test_without_a_pose_from_before_a_stale_one_is_the_first(locate):
    fault = PoseStale(Staleness())
    find = locate(fault)
    first = find()
    assert not fault.took_effect()
    assert find() is first
    assert fault.took_effect()


def test_a_biased_inclinometer_is_off_by_a_constant(bench):
    fault = InclinometerBias(Bias(roll="0.1 rad", pitch="-0.2 rad"))
    inclinometer = bench.around(fault)[INCLINOMETER]
    bench.level.now = 0.0
    assert (inclinometer.read().roll_rad, fault.took_effect()) == (0.0, False)
    bench.level.now = 0.5
    reading = inclinometer.read()
    assert (reading.roll_rad, reading.pitch_rad) == pytest.approx((0.05, -0.1))
    assert fault.took_effect()
