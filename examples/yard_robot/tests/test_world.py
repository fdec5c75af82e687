"""The yard in motion."""

from __future__ import annotations

import math

import pytest
from longarm import Action, Outcome, Reason

from yard_robot.config import YardConfig
from yard_robot.world import World

SPEED = 0.3


def finish(world: World, action: Action) -> Outcome:
    for _ in range(100):
        if (outcome := action.poll()) is not None:
            return outcome
        world.advance()
    raise AssertionError("the action did not end within 100 ticks")


def heading(world: World) -> float:
    _, rotation = world.body.pose()
    return math.atan2(rotation[1, 0], rotation[0, 0])


def test_straight_drive_advances_by_the_tread_travel(world):
    outcome = finish(world, world.wheels.drive(1.0, 1.0, SPEED))
    assert outcome.reason is Reason.DONE
    assert world.body.pose()[0][:2] == pytest.approx([6.0, 0.0], abs=5e-3)


def test_encoders_count_what_was_commanded(world):
    reading = finish(world, world.wheels.drive(0.4, 0.7, SPEED)).value
    assert (reading.left_m, reading.right_m) == pytest.approx((0.4, 0.7), abs=1e-9)


def test_turn_on_the_spot_follows_the_grounds_efficiency(world):
    finish(world, world.wheels.drive(-0.4, 0.4, SPEED))
    efficiency = world.config.ground.turning
    assert heading(world) == pytest.approx(efficiency * 0.8 / world.rig.rover.track_gauge_m, abs=5e-3)


def test_slip_shortens_the_way_but_not_the_count(world):
    world.slip = (0.4, 0.4)
    reading = finish(world, world.wheels.drive(1.0, 1.0, SPEED)).value
    assert reading.left_m == pytest.approx(1.0)
    assert world.body.pose()[0][0] == pytest.approx(5.6, abs=5e-3)


def test_slip_of_one_side_turns_the_robot_to_it(world):
    world.slip = (0.4, 0.0)
    finish(world, world.wheels.drive(1.0, 1.0, SPEED))
    assert heading(world) > math.radians(5.0)


def test_stop_ends_the_drive_and_the_motion(world):
    action = world.wheels.drive(2.0, 2.0, SPEED)
    world.advance()
    world.wheels.stop()
    assert action.poll().reason is Reason.CANCELLED
    world.advance()
    before = world.body.pose()[0]
    world.advance()
    assert world.body.pose()[0] == pytest.approx(before, abs=1e-9)
    assert not world.wheels.read().moving


def test_new_drive_replaces_the_one_under_way(world):
    first = world.wheels.drive(2.0, 2.0, SPEED)
    world.advance()
    second = world.wheels.drive(0.1, 0.1, SPEED)
    assert first.poll().reason is Reason.CANCELLED
    assert finish(world, second).reason is Reason.DONE


def test_driving_draws_more_than_rest_and_turning_more_than_both(world):
    at_rest = world.wheels.read().left_current_a
    world.wheels.drive(2.0, 2.0, SPEED)
    world.advance()
    rolling = world.wheels.read().left_current_a
    world.wheels.drive(-2.0, 2.0, SPEED)
    world.advance()
    assert at_rest < rolling < world.wheels.read().left_current_a


def test_level_robot_reads_no_tilt(world):
    reading = world.inclinometer.read()
    assert abs(reading.roll_rad) < math.radians(1.0)
    assert abs(reading.pitch_rad) < math.radians(1.0)


@pytest.mark.parametrize("seed", [1, 2])
def test_equal_seeds_make_equal_worlds(make_world, seed):
    ends = []
    for _ in range(2):
        world = make_world(YardConfig(), seed)
        finish(world, world.wheels.drive(0.9, 1.2, SPEED))
        ends.append((world.body.placed(), world.wheels.read(), world.inclinometer.read()))
    assert ends[0] == ends[1]


def test_other_seed_makes_another_start(make_world):
    one, other = make_world(YardConfig(), 1), make_world(YardConfig(), 2)
    assert one.body.placed() != other.body.placed()
