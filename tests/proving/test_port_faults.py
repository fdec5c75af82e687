"""Faults of the ports, on the fake robot: they must act on any backend."""

import numpy as np
import pytest

from executive.backends import BackendRequest
from executive.faults import Cue
from executive.rig import RigCalibration
from executive.testing.fake import FakeBackend, FakeWorld
from executive.types import Images, Outcome, Point, Reason, Segment, Shot, Window
from proving.faults.cameras import FrozenFrame
from proving.faults.parameters import Nothing
from proving.faults.tracks import EncoderScale, Scale

ROUTE = (Segment(Point(3.0, 0.0), Point(4.0, 0.0), 0.03, 0.25, 0.03),)
SHOT = Shot((0, 1, 2, 4, 8))


class Switch:
    on = True

    def __call__(self):
        return self.on


@pytest.fixture
def active():
    return Switch()


@pytest.fixture
def cue(robot, active):
    """The fault is there as long as `active.on`."""
    return Cue(lambda: float(active()), robot.clock, np.random.default_rng(1))


@pytest.fixture
def robot():
    return FakeBackend(BackendRequest(FakeWorld(), ROUTE, 1, "geometric", RigCalibration(), None, 1.0))


def finish(robot, action):
    while (outcome := action.poll()) is None:
        robot.advance()
    return outcome


def test_a_miscounting_encoder_reads_as_commanded_while_the_belt_stops_short(robot, active, cue):
    fault = EncoderScale(Scale(side="left", factor=1.25))
    tracks = fault.wrap(robot.devices, cue).tracks
    outcome = finish(robot, tracks.drive(0.1, 0.1, 0.0014))
    assert outcome.value.left_m == pytest.approx(0.1)
    assert tracks.read().left_m == pytest.approx(0.1)
    assert robot.robot.left_m == pytest.approx(0.08)
    assert robot.robot.right_m == pytest.approx(0.1)
    assert fault.took_effect()


def test_a_miscounting_encoder_does_not_jump_when_it_recovers(robot, active, cue):
    tracks = EncoderScale(Scale(side="right", factor=0.8)).wrap(robot.devices, cue).tracks
    finish(robot, tracks.drive(0.1, 0.1, 0.0014))
    active.on = False
    assert tracks.read().right_m == pytest.approx(0.1)
    finish(robot, tracks.drive(0.05, 0.05, 0.0014))
    assert tracks.read().right_m == pytest.approx(0.15)
    assert robot.robot.right_m == pytest.approx(0.175)


def test_an_encoder_fault_has_no_effect_while_the_rover_rests(robot, active, cue):
    fault = EncoderScale(Scale(side="left"))
    tracks = fault.wrap(robot.devices, cue).tracks
    robot.advance()
    tracks.read()
    assert not fault.took_effect()


def test_a_cancelled_drive_stays_cancelled_behind_the_fault(robot, active, cue):
    tracks = EncoderScale(Scale(side="left")).wrap(robot.devices, cue).tracks
    action = tracks.drive(0.1, 0.1, 0.0014)
    robot.advance()
    tracks.stop()
    assert finish(robot, action).reason is Reason.CANCELLED


def test_a_frozen_frame_shows_no_marker_in_the_geometric_tier(robot, active, cue):
    fault = FrozenFrame(Nothing())
    cameras = fault.wrap(robot.devices, cue).cameras
    assert not fault.took_effect()
    assert np.isnan(finish(robot, cameras.take(SHOT)).value.uv_px).all()
    assert fault.took_effect()
    active.on = False
    assert np.isfinite(finish(robot, cameras.take(SHOT)).value.uv_px).all()


def test_a_frozen_frame_is_the_first_of_its_shot_over_and_over(robot, active, cue):
    counts = np.arange(2 * 5 * 4 * 3, dtype=np.uint16).reshape(2, 5, 4, 3)
    head = robot.devices.head.read()
    images = Images(0.0, SHOT, (Window(0, 0, 3, 4),) * 2, (counts[0], counts[1]), head)

    class Ready:
        def take(self, shot):
            return self

        def poll(self):
            return Outcome(Reason.DONE, value=images)

    from dataclasses import replace

    cameras = FrozenFrame(Nothing()).wrap(replace(robot.devices, cameras=Ready()), cue).cameras
    seen = cameras.take(SHOT).poll().value
    for camera in (0, 1):
        assert seen.counts[camera].shape == (5, 4, 3)
        assert (seen.counts[camera] == counts[camera][0]).all()
    assert (images.counts[0] == counts[0]).all()
