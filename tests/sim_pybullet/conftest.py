"""Worlds that the tests close."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import pytest

from sim_pybullet.world import World
from tests.sim_pybullet.worlds import make_world

WorldMaker = Callable[..., World]


@pytest.fixture
def world_of() -> Iterator[WorldMaker]:
    """`make_world`, closing what it made."""
    made: list[World] = []

    def make(*args: Any, **kwargs: Any) -> World:
        made.append(make_world(*args, **kwargs))
        return made[-1]

    yield make
    for world in made:
        world.close()
