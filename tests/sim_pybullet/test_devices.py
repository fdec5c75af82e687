"""The devices behind the ports: tracks, head, cabin, tether, inclinometers, link."""

from __future__ import annotations

import math

import numpy as np
import pytest

from executive.core.clock import Clock
from executive.core.rig import HeadCalibration
from executive.core.types import Call, Reason
from sim_pybullet.head import SimHead
from sim_pybullet.lay import Bend
from sim_pybullet.link import SimLink
from sim_pybullet.rover import CABIN_LINK
from sim_pybullet.tether import DRAG_N, SLACK_M
from tests.sim_pybullet.conftest import WorldMaker
from tests.sim_pybullet.worlds import (
    drive,
    finish,
    plain,
    travel,
)

pytestmark = pytest.mark.sim


def quat_matrix(quat: tuple[float, float, float, float]) -> np.ndarray:
    from scipy.spatial.transform import Rotation

    return Rotation.from_quat(quat).as_matrix()


@pytest.mark.parametrize(("arm_deg", "cabin_deg"), [(0, 0), (30, 0), (30, 25), (10, -40), (60, 60)])
def test_cabin_stands_where_the_rig_says(world_of: WorldMaker, arm_deg: float, cabin_deg: float) -> None:
    """Bullet's own link pose against T_body_plc as core.rig documents it, written out here once more."""
    world = world_of(plain())
    outcome = finish(world, world.cabin.move(math.radians(arm_deg), math.radians(cabin_deg)))
    assert outcome.ok
    arm, cabin = (math.radians(v) for v in (arm_deg, cabin_deg))
    assert world.body.cabin_angles() == pytest.approx((arm, cabin), abs=math.radians(0.1))
    rig = world.rig.cabin
    pivot = np.array(rig.arm_pivot_body_m) + rig.arm_length_m * np.array([math.cos(arm), 0, math.sin(arm)])
    ahead = np.array([math.cos(cabin), 0.0, math.sin(cabin)])
    normal = np.array([-math.sin(cabin), 0.0, math.cos(cabin)])
    origin = pivot + rig.plc_offset_cabin_m[0] * ahead + rig.plc_offset_cabin_m[2] * normal
    position, rotation = world.body.pose()
    at, quat = world.body.link_pose(CABIN_LINK)
    assert np.linalg.norm(np.array(at) - (position + rotation @ pivot)) < 0.0005
    assert np.abs(rotation.T @ quat_matrix(quat) @ [1, 0, 0] - ahead).max() < 0.003
    scene = world.scene()
    assert np.linalg.norm(scene.T_site_plc[:3, 3] - (position + rotation @ origin)) < 0.0005
    assert np.abs(scene.T_site_plc[:3, 2] - rotation @ normal).max() < 0.003


def test_lifting_the_cabin_does_not_move_the_rover(world_of: WorldMaker) -> None:
    world = world_of(plain(roughness="8 mm"))
    start, _ = world.body.pose()
    finish(world, world.cabin.move(math.radians(50), math.radians(20)))
    assert travel(start, world.body.pose()[0]) < 0.002


@pytest.mark.parametrize(("arm_deg", "cabin_deg"), [(61, 0), (-1, 0), (0, 61), (float("nan"), 0)])
def test_cabin_refuses_what_is_out_of_reach(world_of: WorldMaker, arm_deg: float, cabin_deg: float) -> None:
    world = world_of(plain())
    outcome = world.cabin.move(math.radians(arm_deg), math.radians(cabin_deg)).poll()
    assert outcome is not None
    assert outcome.reason is Reason.OUT_OF_REACH
    assert not world.cabin.moving


def test_cabin_sensors_scatter_as_calibrated(world_of: WorldMaker) -> None:
    world = world_of(plain())
    readings = []
    for _ in range(300):
        world.advance()
        readings.append(world.cabin.read().arm_rad)
    assert np.std(readings) == pytest.approx(world.rig.cabin.joint_sigma_rad, rel=0.2)


def test_drive_ends_at_the_travels_and_both_belts_end_together(world_of: WorldMaker) -> None:
    world = world_of(plain())
    outcome = drive(world, 0.10, -0.04)
    assert outcome.ok
    assert outcome.value.left_m == pytest.approx(0.10, abs=1e-4)
    assert outcome.value.right_m == pytest.approx(-0.04, abs=1e-4)
    assert world.clock.ticks == math.ceil(0.10 / 0.0014)


def test_new_drive_cancels_the_one_under_way(world_of: WorldMaker) -> None:
    world = world_of(plain())
    first = world.tracks.drive(0.1, 0.1, 0.0014)
    world.advance()
    second = world.tracks.drive(-0.01, -0.01, 0.0014)
    assert first.poll() is not None
    assert first.poll().reason is Reason.CANCELLED
    assert finish(world, second).ok


def test_cancelled_drive_leaves_the_rover_at_rest(world_of: WorldMaker) -> None:
    world = world_of(plain())
    action = world.tracks.drive(0.1, 0.1, 0.0014)
    for _ in range(10):
        world.advance()
    action.cancel()
    world.advance()
    place, _ = world.body.pose()
    for _ in range(50):
        world.advance()
    assert travel(place, world.body.pose()[0]) < 0.0002
    assert not world.tracks.read().moving


def test_tracks_do_not_run_faster_than_their_motors(world_of: WorldMaker) -> None:
    world = world_of(plain())
    finish(world, world.tracks.drive(0.07, 0.07, 1.0))
    assert world.clock.ticks == 50


def test_impossible_travels_are_refused(world_of: WorldMaker) -> None:
    world = world_of(plain())
    for travels in ((math.nan, 0.1, 0.001), (0.1, 0.1, 0.0), (0.1, math.inf, 0.001)):
        outcome = world.tracks.drive(*travels).poll()
        assert outcome is not None
        assert outcome.reason is Reason.OUT_OF_REACH


def test_weak_motor_shows_in_its_encoder(world_of: WorldMaker) -> None:
    world = world_of(plain())
    world.tracks.motors[0].speed_factor = 0.5
    world.tracks.drive(0.1, 0.1, 0.0014)
    for _ in range(30):
        world.advance()
    reading = world.tracks.read()
    assert reading.left_m / reading.right_m == pytest.approx(0.5, abs=0.01)


def test_reading_twice_in_a_tick_gives_the_same(world_of: WorldMaker) -> None:
    world = world_of(plain())
    for device in (world.tracks, world.cabin, world.inclinometer, world.tether):
        assert device.read() == device.read()


def test_inclinometers_read_the_slope(world_of: WorldMaker) -> None:
    world = world_of(plain(slope="12 deg"))
    readings = []
    for _ in range(100):
        world.advance()
        readings.append(world.inclinometer.read())
    assert np.mean([r.pitch_rad for r in readings]) == pytest.approx(-math.radians(12), abs=math.radians(0.1))
    assert np.mean([r.roll_rad for r in readings]) == pytest.approx(0.0, abs=math.radians(0.1))
    assert np.std([r.roll_rad for r in readings]) == pytest.approx(math.radians(0.1), rel=0.3)


def pointed(seed: int) -> SimHead:
    clock = Clock(1.0)
    head = SimHead(HeadCalibration(), clock, np.random.default_rng(seed))
    action = head.point(0.3, 0.2)
    while action.poll() is None:
        head.advance(1.0)
        clock.advance()
        head.settle()
    return head


def test_head_misses_uniformly_within_its_accuracy_and_does_not_know() -> None:
    heads = [pointed(seed) for seed in range(300)]
    pan = np.array([h.true_rad[0] - 0.3 for h in heads]) / HeadCalibration().pan_accuracy_rad
    tilt = np.array([h.true_rad[1] - 0.2 for h in heads]) / HeadCalibration().tilt_accuracy_rad
    assert {(h.read().pan_rad, h.read().tilt_rad) for h in heads} == {(0.3, 0.2)}
    for error in (pan, tilt):
        assert 0.95 < np.abs(error).max() <= 1.0
        assert error.std() == pytest.approx(1 / math.sqrt(3), rel=0.1)


def test_head_takes_the_time_of_its_longer_axis() -> None:
    clock = Clock(1.0)
    head = SimHead(HeadCalibration(), clock, np.random.default_rng(0))
    action = head.point(math.radians(30), math.radians(6))
    while action.poll() is None:
        head.advance(1.0)
        clock.advance()
        head.settle()
    assert clock.ticks == 10


def test_head_refuses_what_is_out_of_reach() -> None:
    head = SimHead(HeadCalibration(), Clock(1.0), np.random.default_rng(0))
    outcome = head.point(0.0, math.radians(81)).poll()
    assert outcome is not None
    assert outcome.reason is Reason.OUT_OF_REACH
    assert head.read().tilt_rad == 0.0


def test_tether_pays_out_when_leaving_and_slackens_when_returning(world_of: WorldMaker) -> None:
    world = world_of(plain())
    start_m = world.tether.length_m
    assert start_m == pytest.approx(math.hypot(2.835, 0.255) + SLACK_M, abs=0.01)
    drive(world, 0.2, 0.2)
    out_m = world.tether.length_m
    assert out_m == pytest.approx(start_m + 0.2 - SLACK_M, abs=0.01)
    assert world.tether.tension_n == pytest.approx(DRAG_N)
    drive(world, -0.1, -0.1)
    assert world.tether.length_m == pytest.approx(out_m, abs=0.002)
    assert world.tether.tension_n == 0.0


def test_jammed_tether_holds_the_rover_back(world_of: WorldMaker) -> None:
    world = world_of(plain(soil="gravel"))
    drive(world, 0.1, 0.1)
    world.tether.jammed = True
    start, _ = world.body.pose()
    world.tracks.drive(0.3, 0.3, 0.0014)
    for _ in range(220):
        world.advance()
    gone_m = world.body.pose()[0][0] - start[0]
    weight_n = world.weight_n
    assert gone_m < 0.1
    assert 0.4 * weight_n < world.tether.tension_n < 0.9 * weight_n


def test_a_rover_that_the_tether_drags_back_comes_no_farther_than_the_tether_was_stretched(
    world_of: WorldMaker,
) -> None:
    world = world_of(plain(soil="gravel"))
    drive(world, 0.1, 0.1)
    stretched_m = 0.04  # pulls with 8 N, and the rover weighs about 10
    world.tether.jammed = True
    world.tether.length_m = world.tether.way_m(world.anchor()) - stretched_m
    before_m = world.body.pose()[0]
    world.wake()
    world.advance()
    assert 0.0 < np.linalg.norm(world.body.pose()[0] - before_m) < stretched_m


def test_a_tether_round_a_rock_holds_back_but_never_pulls(world_of: WorldMaker) -> None:
    world = world_of(plain(soil="gravel"))
    drive(world, 0.1, 0.1)
    start, _ = world.body.pose()
    x, y, z = (start + 0.2 * (world.tether.spool_site_m - start)).tolist()
    world.tether.bend = Bend((x, y, z), capstan=1e6)
    for _ in range(20):
        world.advance()
    assert world.body.pose()[0] == pytest.approx(start, abs=1e-3)
    world.tracks.drive(0.3, 0.3, 0.0014)
    for _ in range(220):
        world.advance()
    assert 0.2 * world.weight_n < world.tether.tension_n < 0.9 * world.weight_n


def test_call_to_ground_is_answered_after_forty_minutes() -> None:
    clock = Clock(60.0)
    link = SimLink(clock)
    action = link.call(Call(0.0, Reason.NO_STRATEGY, "stuck"))
    while action.poll() is None:
        clock.advance()
        link.settle()
    assert clock.now_s == 2400.0
    assert action.poll().ok


@pytest.mark.parametrize(
    ("forces", "blocked"), [((0.3, -0.3), False), ((0.3, 0.3), True), ((0.38, 0.0), True)]
)
def test_belts_that_pull_against_each_other_do_not_block(
    world_of: WorldMaker, forces: tuple[float, float], blocked: bool
) -> None:
    """Shares of the weight; ahead is positive, both belts driving ahead."""
    tracks = world_of(plain()).tracks
    action = tracks.drive(0.1, 0.1, 0.0014)
    weight_n = world_of(plain()).weight_n
    for _ in range(12):
        tracks.feel((forces[0] * weight_n, forces[1] * weight_n), 1.0)
    outcome = action.poll()
    assert (outcome is not None and outcome.reason is Reason.BLOCKED) is blocked
