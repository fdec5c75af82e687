"""The public checker of localizers, on the fake robot's and on some that break a promise."""

from dataclasses import replace

import numpy as np
import pytest

from executive.config.backends import BackendRequest
from executive.core.rig import RigCalibration
from executive.core.types import Point, PoseEstimate, PoseSource, Segment
from executive.testing import OVERHEAD, FakeBackend, FakeWorld, OverheadLocalizer, check_localizer
from executive.testing.check_localizer import LocalizerBreach

THERE = PoseEstimate(
    0.0, (3.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), np.diag([0.05**2] * 3 + [0.1**2] * 3), PoseSource.PRIOR
)
ROUTE = (Segment(Point(3.0, 0.0), Point(4.0, 0.0), 0.03, 0.25, 0.03),)


def backend():
    return FakeBackend(BackendRequest(FakeWorld(), ROUTE, 1, "geometric", RigCalibration(), None, 1.0))


def made_by(kind):
    return replace(OVERHEAD, make=lambda r: kind(r.devices, r.rig, r.clock))


class Unending(OverheadLocalizer):
    def locate(self, request):
        return Never()


class Never:
    def poll(self):
        return None

    def cancel(self):
        return None


class LookingAway(OverheadLocalizer):
    def pointing(self, pose):
        return 9.0, 0.0


def test_the_overhead_localizer_keeps_every_promise():
    check_localizer(OVERHEAD, backend, THERE, "geometric")


@pytest.mark.parametrize(
    ("spec", "tier", "said"),
    [
        (replace(OVERHEAD, doc=" "), "geometric", "does not say what it is"),
        (replace(OVERHEAD, sources=("trend",)), "geometric", "no fix"),
        (replace(OVERHEAD, expected_markers=lambda rig: 2), "geometric", "2 markers at most, got 4"),
        (OVERHEAD, "full", "got the tier full"),
        (made_by(Unending), "geometric", "ends within its budget"),
        (made_by(LookingAway), "geometric", "a head can look"),
    ],
)
def test_a_broken_promise_is_named(spec, tier, said):
    with pytest.raises(LocalizerBreach, match=said):
        check_localizer(spec, backend, THERE, tier)
