"""Where things lie at the start: rocks, obstacles, the rover; and that a seed is all that decides it."""

from __future__ import annotations

import math
import subprocess
import sys

import numpy as np
import pytest

from executive.core.rig import RigCalibration
from sim_pybullet.config import WorldConfig
from sim_pybullet.site import make_rocks, make_terrain
from sim_pybullet.truth import TruthSample
from tests.sim_pybullet.conftest import WorldMaker
from tests.sim_pybullet.worlds import (
    AHEAD,
    drive,
    heading,
    plain,
    route,
)

pytestmark = pytest.mark.sim

CROOKED = route((2.6, -0.4), (3.2, 0.1), (4.0, 0.2))

TRAVERSE = """
import hashlib
from tests.sim_pybullet.worlds import drive, finish, make_world, plain, route
world = make_world(
    plain(roughness="8 mm", soil="loose_sand"), seed={seed}, segments=route((2.6, -0.4), (3.2, 0.1))
)
digest = hashlib.sha256()
for left, right in ((0.15, 0.15), (-0.02, 0.02), (0.1, 0.09)):
    drive(world, left, right)
    position, rotation = world.body.pose()
    digest.update(position.tobytes() + rotation.tobytes())
finish(world, world.cabin.move(0.4, 0.1))
digest.update(repr((world.inclinometer.read(), world.tracks.read(), world.tether.read())).encode())
digest.update(world.scene().T_site_plc.tobytes())
print(digest.hexdigest())
"""


def fresh_process(seed: int) -> str:
    script = TRAVERSE.replace("{seed}", str(seed))
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    return done.stdout.strip()


def test_same_seed_gives_bit_identical_poses_in_two_fresh_processes() -> None:
    one, again, other = fresh_process(7), fresh_process(7), fresh_process(8)
    assert len(one) == 64
    assert one == again
    assert one != other


@pytest.mark.parametrize("seed", range(5))
def test_scattered_rocks_leave_the_route_and_the_lander_clear(seed: int) -> None:
    config = WorldConfig.model_validate({"terrain": {"procedural": {"rocks": 60, "width": "12 m"}}})
    terrain = make_terrain(config.terrain, CROOKED, seed)
    rocks = make_rocks(config, terrain, CROOKED, RigCalibration(), seed)
    assert len(rocks) == 60
    for rock in rocks:
        x, y, z = rock.centre_site_m
        assert math.hypot(x, y) - rock.radius_m >= 1.0
        assert z < terrain.height(x, y) < z + rock.radius_m  # buried, but showing
        for share in np.linspace(0, 1, 50):
            for s in CROOKED:
                px = s.start.x_m + share * (s.end.x_m - s.start.x_m)
                py = s.start.y_m + share * (s.end.y_m - s.start.y_m)
                assert math.hypot(x - px, y - py) > rock.radius_m + s.off_track_m + 0.165 / 2


def test_obstacles_lie_exactly_where_asked(world_of: WorldMaker) -> None:
    asked = {"at": {"x": "3.6 m", "y": "-0.1 m"}, "radius": "60 mm", "height": "10 mm"}
    world = world_of(plain(roughness="6 mm", obstacles=[asked]))
    (rock,) = world.rocks
    assert rock.radius_m == 0.06
    assert rock.centre_site_m == (3.6, -0.1, pytest.approx(world.terrain.height(3.6, -0.1) + 0.01))
    assert world.scene().rocks == (rock,)


def test_rover_starts_at_the_first_waypoint_looking_away_from_the_lander(world_of: WorldMaker) -> None:
    config = {"terrain": {"procedural": {"roughness": "4 mm", "rocks": 0, "width": "12 m"}}}
    headings = []
    for seed in range(6):
        position, rotation = world_of(config, seed=seed, segments=CROOKED).body.pose()
        assert math.hypot(position[0] - 2.6, position[1] + 0.4) < 0.02
        headings.append(math.degrees(heading(rotation) - math.atan2(-0.4, 2.6)))
    assert np.abs(headings).max() < 11.0
    assert np.std(headings) > 1.0


def test_asked_heading_is_taken(world_of: WorldMaker) -> None:
    config = plain()
    config["start"] = {"heading": "90 deg"}
    assert heading(world_of(config).body.pose()[1]) == pytest.approx(math.pi / 2, abs=0.01)


def test_truth_is_sampled_every_tick_in_motion_and_seldom_at_rest(world_of: WorldMaker) -> None:
    samples: list[TruthSample] = []
    world = world_of(plain(), truth=samples.append)
    drive(world, 0.014, 0.014)
    moving = [s for s in samples if s.time_s > 0]
    assert [s.time_s for s in moving] == [float(t) for t in range(1, 11)]
    assert [s.driving for s in moving] == [True] * 9 + [False]
    x, y, z = moving[-1].position_site_m
    assert (x, y, z) == tuple(world.body.pose()[0])
    for _ in range(600):
        world.advance()
    assert len(samples) - len(moving) == pytest.approx(11, abs=1)


def test_route_ahead_is_driven_where_the_heightfield_lies(world_of: WorldMaker) -> None:
    """Bullet's heightfield and the terrain that cameras see are the same ground."""
    world = world_of(plain(roughness="10 mm"), segments=AHEAD)
    for _ in range(3):
        drive(world, 0.1, 0.1)
        position, rotation = world.body.pose()
        track = [
            position + rotation @ (x, y, 0.0) for x in np.linspace(-0.14, 0.14, 15) for y in (-0.0625, 0.0625)
        ]
        gaps = [p[2] - world.terrain.height(p[0], p[1]) for p in track]
        assert -0.004 < min(gaps) < 0.002
