"""Faults of the track encoders and motors, on the fake robot: they must act on any backend."""

import math

import pytest

from executive.core.devices import DRIVE
from executive.core.types import Reason
from proving.faults.parameters import OneTrack
from proving.faults.tracks import (
    CurrentsGarbage,
    EncoderLostCounts,
    EncoderScale,
    EncoderStuck,
    Garbage,
    Loss,
    Scale,
)

SPEED_M_S = 0.0014


def drive(bench, fault, left_m=0.1, right_m=0.1):
    tracks = bench.around(fault)[DRIVE]
    return tracks, bench.finish(tracks.drive(left_m, right_m, SPEED_M_S))


def test_a_miscounting_encoder_reads_as_commanded_while_the_belt_stops_short(bench):
    fault = EncoderScale(Scale(side="left", factor=1.25))
    tracks, outcome = drive(bench, fault)
    assert outcome.value.left_m == pytest.approx(0.1)
    assert tracks.read().left_m == pytest.approx(0.1)
    assert bench.robot.robot.left_m == pytest.approx(0.08)
    assert bench.robot.robot.right_m == pytest.approx(0.1)
    assert fault.took_effect()


def test_half_a_scale_miscounts_half_as_much(bench):
    bench.level.now = 0.5
    drive(bench, EncoderScale(Scale(side="left", factor=1.5)))
    assert bench.robot.robot.left_m == pytest.approx(0.08)


def test_a_miscounting_encoder_does_not_jump_when_it_recovers(bench):
    tracks, _ = drive(bench, EncoderScale(Scale(side="right", factor=0.8)))
    bench.level.now = 0.0
    assert tracks.read().right_m == pytest.approx(0.1)
    bench.finish(tracks.drive(0.05, 0.05, SPEED_M_S))
    assert tracks.read().right_m == pytest.approx(0.15)
    assert bench.robot.robot.right_m == pytest.approx(0.175)


@pytest.mark.parametrize("fault", [EncoderScale(Scale(side="left")), EncoderStuck(OneTrack(side="left"))])
def test_an_encoder_fault_has_no_effect_while_the_rover_rests(bench, fault):
    tracks = bench.around(fault)[DRIVE]
    bench.robot.advance()
    tracks.read()
    assert not fault.took_effect()


@pytest.mark.parametrize("fault", [EncoderScale(Scale(side="left")), EncoderStuck(OneTrack(side="left"))])
def test_a_cancelled_drive_stays_cancelled_behind_the_fault(bench, fault):
    tracks = bench.around(fault)[DRIVE]
    action = tracks.drive(0.1, 0.1, SPEED_M_S)
    bench.robot.advance()
    tracks.stop()
    assert bench.finish(action).reason is Reason.CANCELLED


def test_a_belt_whose_encoder_is_stuck_runs_on_until_it_is_stopped(bench):
    fault = EncoderStuck(OneTrack(side="left"))
    tracks = bench.around(fault)[DRIVE]
    action = tracks.drive(0.02, 0.02, SPEED_M_S)
    for _ in range(100):
        assert action.poll() is None
        bench.robot.advance()
    assert tracks.read().left_m == 0.0
    assert tracks.read().right_m == pytest.approx(0.02)
    assert bench.robot.robot.left_m > 0.1
    assert fault.took_effect()
    tracks.stop()
    assert action.poll().reason is Reason.CANCELLED
    assert not bench.robot.robot.moving


def test_a_drive_ends_once_a_stuck_encoder_counts_again(bench):
    tracks = bench.around(EncoderStuck(OneTrack(side="right")))[DRIVE]
    action = tracks.drive(0.02, 0.02, SPEED_M_S)
    for _ in range(30):
        action.poll()
        bench.robot.advance()
    bench.level.now = 0.0
    outcome = bench.finish(action)
    assert outcome.ok
    assert tracks.read().right_m == pytest.approx(0.02, abs=0.0006)
    assert bench.robot.robot.right_m > 0.035


def test_an_encoder_that_loses_counts_lets_the_belt_run_further(bench):
    fault = EncoderLostCounts(Loss(side="right", share=0.3))
    _, outcome = drive(bench, fault, 0.5, 0.5)
    assert outcome.value.right_m == pytest.approx(0.5, abs=0.02)
    assert bench.robot.robot.right_m == pytest.approx(0.5 / 0.7, rel=0.05)
    assert bench.robot.robot.left_m == pytest.approx(0.5)
    assert fault.took_effect()


def test_a_garbled_current_is_anything_and_the_rest_is_true(bench):
    fault = CurrentsGarbage(Garbage(side="left", up_to="2 A"))
    tracks = bench.around(fault)[DRIVE]
    seen = [tracks.read() for _ in range(100)]
    assert any(math.isnan(reading.left_current_a) for reading in seen)
    assert len({reading.left_current_a for reading in seen}) > 50
    assert {reading.right_current_a for reading in seen} == {0.02}
    assert fault.took_effect()
