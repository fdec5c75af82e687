"""The pan-tilt unit out of true: it turns about the axes that it is said to turn about."""

import math

import numpy as np
import pytest

from executive.core.rig import HeadCalibration
from perception.geometry.head_model import axes_site, head_rates, site_ih
from perception.geometry.rotation import skew

OUT_OF_TRUE = HeadCalibration(
    pan_zero_rad=0.02, tilt_zero_rad=-0.01, lean_rad=(0.03, -0.05), axes_skew_rad=0.04
)
LOOK_RAD = (math.radians(35.0), math.radians(12.0))


@pytest.mark.parametrize("head", [HeadCalibration(), OUT_OF_TRUE])
def test_the_head_turns_about_its_axes(head):
    rotation = site_ih(head, LOOK_RAD).rotation
    for axis, rate in zip(axes_site(head, LOOK_RAD), head_rates(head, LOOK_RAD), strict=True):
        assert np.linalg.norm(axis) == pytest.approx(1.0)
        assert skew(axis) @ rotation == pytest.approx(rate, abs=1e-12)


def test_a_head_that_leans_pans_about_no_vertical_axis():
    pan_axis, _ = axes_site(OUT_OF_TRUE, LOOK_RAD)
    assert math.acos(pan_axis[2]) == pytest.approx(math.hypot(*OUT_OF_TRUE.lean_rad), rel=1e-3)
