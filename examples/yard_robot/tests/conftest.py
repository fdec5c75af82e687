"""A yard without scatter, and the models that tests need of it."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import pytest
from executive.core.clock import Clock
from longarm import Point, Segment

from yard_robot.config import GroundConfig, StartConfig, YardConfig
from yard_robot.rig import YardRig
from yard_robot.world import World

ROUTE = (Segment(Point(5.0, 0.0), Point(8.0, 0.0), 0.1, 0.8, 0.15, 0),)
EVEN = YardConfig(
    ground=GroundConfig(patches=0, scatter="0 %"), start=StartConfig(place="0 m", heading="0 deg")
)

Make = Callable[..., World]


@pytest.fixture
def make_world() -> Iterator[Make]:
    """Makes worlds, by default an even one, and releases them after the test."""
    made: list[World] = []

    def make(config: YardConfig = EVEN, seed: int = 1) -> World:
        made.append(World(config, ROUTE, seed, YardRig(), Clock(1.0)))
        return made[-1]

    yield make
    for world in made:
        world.close()


@pytest.fixture
def world(make_world: Make) -> World:
    return make_world()
