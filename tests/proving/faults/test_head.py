"""Faults of the head, on the fake robot."""

import pytest

from executive.core.devices import CAMERAS, HEAD
from proving.faults.head import HeadEncoderOffset, HeadOffset
from tests.proving.faults.bench import SHOT


def test_an_offset_encoder_says_what_was_asked_and_points_elsewhere(bench):
    fault = HeadEncoderOffset(HeadOffset(pan="0.01 rad", tilt="-0.02 rad"))
    devices = bench.around(fault)
    outcome = bench.finish(devices[HEAD].point(0.3, 0.4))
    assert (outcome.value.pan_rad, outcome.value.tilt_rad) == pytest.approx((0.3, 0.4))
    assert (devices[HEAD].read().pan_rad, devices[HEAD].read().tilt_rad) == pytest.approx((0.3, 0.4))
    assert (bench.robot.robot.pan_rad, bench.robot.robot.tilt_rad) == pytest.approx((0.29, 0.42))


def test_an_image_is_stamped_with_what_the_encoders_say(bench):
    fault = HeadEncoderOffset(HeadOffset(pan="0.01 rad"))
    bench.level.now = 0.5
    cameras = bench.around(fault)[CAMERAS]
    assert not fault.took_effect()
    assert bench.finish(cameras.take(SHOT)).value.head.pan_rad == pytest.approx(0.005)
    assert fault.took_effect()
