"""The rover on the ground: traction, slip, turning, rest, obstacles; measured from true poses."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from executive.core.types import Reason
from sim_pybullet.bullet import pybullet
from sim_pybullet.rover import BELLY_FRICTION, BODY_LINK, CABIN_LINK, SHOES
from sim_pybullet.shape import belt
from sim_pybullet.soil import SOILS, thrust_ratio
from sim_pybullet.tether import DRAG_N
from sim_pybullet.world import World
from tests.sim_pybullet.conftest import WorldMaker
from tests.sim_pybullet.worlds import (
    EVEN_SOIL,
    drive,
    heading,
    plain,
    travel,
)

pytestmark = pytest.mark.sim


def encoder_slip(world: World) -> float:
    """Slip from the true path and what the encoders counted."""
    world.tracks.gains = (1.0, 1.0)
    drive(world, 0.1, 0.1)  # into steady motion
    start, counted = world.body.pose()[0], world.tracks.read().left_m
    drive(world, 0.4, 0.4)
    return 1.0 - travel(start, world.body.pose()[0]) / (world.tracks.read().left_m - counted)


def slip_by_law(world: World, slope_rad: float, soil: str) -> float:
    """The law solved on a grid for what a rover that looks uphill carries: its weight and its tether."""
    uphill = np.array([math.cos(slope_rad), 0.0, math.sin(slope_rad)])
    normal = np.array([-math.sin(slope_rad), 0.0, math.cos(slope_rad)])
    to_spool = -world.body.pose()[0] / np.linalg.norm(world.body.pose()[0])
    load_n = DRAG_N * to_spool - np.array([0.0, 0.0, world.weight_n])
    wanted = -float(load_n @ uphill) / (-SOILS[soil].friction * float(load_n @ normal))
    grid = np.linspace(1e-4, 1.0, 20_000)
    length_m = belt(world.rig).length_m
    misfit = [abs(thrust_ratio(s, length_m, SOILS[soil].shear_m) - wanted) for s in grid]
    return float(grid[np.argmin(misfit)])


@pytest.mark.parametrize("soil", ["loose_sand", "gravel"])
@pytest.mark.parametrize(("slope_deg", "within"), [(5, 0.02), (10, 0.02), (20, 0.02), (25, 0.1), (30, 0.1)])
def test_slip_over_slope_follows_the_analytic_law(
    world_of: WorldMaker, slope_deg: float, within: float, soil: str
) -> None:
    """Above 20 degrees the soles also slide a little where they cross the edges of the ground's triangles."""
    world = world_of(plain(slope=f"{slope_deg} deg", soil={"like": soil, **EVEN_SOIL}))
    slip = encoder_slip(world)
    assert slip == pytest.approx(slip_by_law(world, math.radians(slope_deg), soil), rel=within)


def test_slip_on_level_ground_is_below_one_per_mille(world_of: WorldMaker) -> None:
    world = world_of(plain(soil={"like": "gravel", **EVEN_SOIL}))
    assert abs(encoder_slip(world)) < 1e-3


def test_rover_cannot_climb_beyond_its_friction(world_of: WorldMaker) -> None:
    slope = math.degrees(math.atan(SOILS["loose_sand"].friction)) - 1.0
    world = world_of(plain(slope=f"{slope} deg", soil={"like": "loose_sand", **EVEN_SOIL}))
    start = world.body.pose()[0]
    world.tracks.drive(0.2, 0.2, 0.0014)
    for _ in range(140):
        world.advance()
    assert travel(start, world.body.pose()[0]) < 0.02


def test_rover_does_not_creep_on_a_25_degree_slope(world_of: WorldMaker) -> None:
    """Ten minutes of mission time, the physics awake all the while."""
    world = world_of(plain(slope="25 deg", soil="gravel", time_scale=10), never_sleep=True)
    start, steps = world.body.pose()[0], world.steps
    for _ in range(600):
        world.advance()
    assert world.steps - steps >= 3600
    assert travel(start, world.body.pose()[0]) < 0.0005


@pytest.mark.parametrize("soil", list(SOILS))
def test_turning_has_the_efficiency_of_the_soil(world_of: WorldMaker, soil: str) -> None:
    world = world_of(plain(roughness="4 mm", soil={"like": soil, **EVEN_SOIL}))
    world.tracks.gains = (1.0, 1.0)
    before = heading(world.body.pose()[1])
    drive(world, -0.06, 0.06)
    ideal_rad = 0.12 / world.rig.rover.track_gauge_m
    turned = heading(world.body.pose()[1]) - before
    assert turned / ideal_rad == pytest.approx(SOILS[soil].yaw_efficiency, rel=0.05)


def test_path_does_not_depend_on_the_time_scale(world_of: WorldMaker) -> None:
    """Under 5 mm a metre between scales 10 and 50, on rough ground, through turns, with scatter."""
    paths = []
    for scale in (10, 50):
        world = world_of(plain(roughness="8 mm", soil="loose_sand", time_scale=scale))
        places = [world.body.pose()[0]]
        for left_m, right_m in ((0.5, 0.5), (-0.03, 0.03), (0.5, 0.5)):
            drive(world, left_m, right_m)
            places.append(world.body.pose()[0])
        paths.append(np.array(places))
    driven_m = sum(travel(a, b) for a, b in pairwise(paths[0]))
    assert driven_m > 0.95
    assert np.linalg.norm(paths[0] - paths[1], axis=1).max() < 0.005 * driven_m


def test_straight_drive_on_loose_sand_wanders_a_little(world_of: WorldMaker) -> None:
    turned = []
    for seed in range(4):
        world = world_of(plain(soil="loose_sand"), seed=seed)
        before = heading(world.body.pose()[1])
        drive(world, 0.5, 0.5)
        turned.append(math.degrees(heading(world.body.pose()[1]) - before))
    assert 0.1 < float(np.abs(turned).max()) < 5.0
    assert float(np.std(turned)) > 0.05


def rock_ahead(y_m: float, radius_m: float = 0.1) -> dict[str, object]:
    return {"at": {"x": f"{3.27 + radius_m} m", "y": f"{y_m} m"}, "radius": f"{radius_m} m"}


@pytest.mark.parametrize("y_m", [0.0, 0.06, -0.06])
def test_big_rock_blocks_the_rover_without_letting_it_through(world_of: WorldMaker, y_m: float) -> None:
    world = world_of(plain(soil="crust", obstacles=[rock_ahead(y_m)]))
    start, _ = world.body.pose()
    outcome = drive(world, 0.5, 0.5)
    end, _ = world.body.pose()
    assert outcome.reason is Reason.BLOCKED
    assert 0.07 < end[0] - start[0] < 0.16  # reached the rock, 0.1 m ahead of its nose, and stayed there
    assert not world.tracks.moving


def test_current_rises_against_a_rock(world_of: WorldMaker) -> None:
    world = world_of(plain(soil="crust", obstacles=[rock_ahead(0.0)]))
    world.tracks.drive(0.5, 0.5, 0.0014)
    currents = []
    while world.tracks.moving:
        world.advance()
        reading = world.tracks.read()
        currents.append(reading.left_current_a + reading.right_current_a)
    assert np.mean(currents[-8:-1]) > 2 * np.mean(currents[5:50])


def test_rover_grounded_on_a_stone_gets_no_further_though_its_tracks_turn(world_of: WorldMaker) -> None:
    """A stone between the tracks takes the load off them, so the motors do not feel it."""
    world = world_of(plain(soil="crust", obstacles=[rock_ahead(0.0, 0.05)]))
    start, _ = world.body.pose()
    outcome = drive(world, 0.3, 0.3)
    assert outcome.value.left_m > 0.15
    assert world.body.pose()[0][0] - start[0] < 0.15


def test_rover_backs_off_from_a_rock(world_of: WorldMaker) -> None:
    world = world_of(plain(soil="crust", obstacles=[rock_ahead(0.0)]))
    assert drive(world, 0.5, 0.5).reason is Reason.BLOCKED
    start, _ = world.body.pose()
    assert drive(world, -0.1, -0.1).ok
    assert start[0] - world.body.pose()[0][0] == pytest.approx(0.1, abs=0.015)


def test_tracks_stand_on_the_ground_at_height_zero_of_the_body(world_of: WorldMaker) -> None:
    position, rotation = world_of(plain()).body.pose()
    assert abs(position[2]) < 0.0005
    assert rotation[2, 2] > 0.99999


def test_bullet_holds_the_friction_asked_for_on_each_link(world_of: WorldMaker) -> None:
    """PyBullet puts link friction on the base, silently, when asked together with damping."""
    body = world_of(plain()).body

    def friction(link: int) -> float:
        return float(pybullet.getDynamicsInfo(body.id, link, physicsClientId=body.client)[1])

    assert [friction(shoe) for shoe in SHOES] == [0.0, 0.0]  # the tracks' grip is the servo's limit
    assert friction(BODY_LINK) == friction(CABIN_LINK) == BELLY_FRICTION


def test_two_tracks_on_two_soils_each_slip_by_their_own(world_of: WorldMaker) -> None:
    """Uphill, with the left track on rock and the right one on sand, the rover turns to the right."""
    config = plain(slope="18 deg", soil={"like": "loose_sand", **EVEN_SOIL})
    config["soil"]["patches"] = [
        {"at": {"x": "3 m", "y": "3 m"}, "radius": "3 m", "soil": {"like": "bedrock", **EVEN_SOIL}}
    ]
    world = world_of(config)
    world.tracks.gains = (1.0, 1.0)
    drive(world, 0.1, 0.1)
    assert heading(world.body.pose()[1]) < -math.radians(0.5)


def test_physics_sleeps_at_rest_and_wakes_on_a_command(world_of: WorldMaker) -> None:
    world = world_of(plain(roughness="8 mm"))
    for _ in range(30):
        world.advance()
    asleep = world.steps
    for _ in range(1000):
        world.advance()
    assert world.steps == asleep
    assert drive(world, 0.05, 0.05).ok
    assert world.steps > asleep


def test_rover_drifts_sideways_on_a_cross_slope(world_of: WorldMaker) -> None:
    config = plain(slope="15 deg", soil={"like": "loose_sand", **EVEN_SOIL})
    config["terrain"]["procedural"]["slope_direction"] = "90 deg"
    world = world_of(config)
    start, _ = world.body.pose()
    drive(world, 0.4, 0.4)
    end, rotation = world.body.pose()
    left = rotation[:, 1]
    expected_m = -0.4 * SOILS["loose_sand"].side_slip * math.tan(math.radians(15))
    assert float((end - start) @ left) == pytest.approx(expected_m, rel=0.1)
