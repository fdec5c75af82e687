"""Small worlds for the tests: a route, a world on plain ground, and driving in it."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np

from executive.core.clock import Clock
from executive.core.ports import Action
from executive.core.rig import RigCalibration
from executive.core.types import (
    Array,
    Outcome,
    Point,
    Segment,
)
from sim_pybullet.config import WorldConfig
from sim_pybullet.truth import TruthSink
from sim_pybullet.world import World

EVEN_SOIL = {"yaw_scatter": "0 %", "slip_scatter": "0 %"}


def route(*points: tuple[float, float]) -> tuple[Segment, ...]:
    """Segments through these points [m], with ordinary margins."""
    ends = [Point(*p) for p in points]
    return tuple(Segment(a, b, 0.03, 0.25, 0.03, i) for i, (a, b) in enumerate(pairwise(ends)))


AHEAD = route((3.0, 0.0), (4.0, 0.0))


def plain(
    roughness: str = "0 mm", slope: str = "0 deg", soil: dict[str, Any] | str = "crust", **world: Any
) -> dict[str, Any]:
    """A `world:` mapping: procedural ground that rises along x, the rover looking along x."""
    return {
        "terrain": {"procedural": {"roughness": roughness, "slope": slope, "width": "12 m", "rocks": 0}},
        "soil": {"default": soil},
        "start": {"heading": "0 deg", "position_error": "0 mm"},
        **world,
    }


def make_world(
    config: dict[str, Any],
    seed: int = 7,
    segments: tuple[Segment, ...] = AHEAD,
    truth: TruthSink = lambda sample: None,
    never_sleep: bool = False,
) -> World:
    """A world from its mapping, with ticks of a second."""
    return World(
        WorldConfig.model_validate(config), segments, seed, RigCalibration(), Clock(1.0), truth, never_sleep
    )


def finish(world: World, action: Action[Any], limit: int = 20_000) -> Outcome[Any]:
    """Let time pass until the action ends; AssertionError if it takes more than `limit` ticks."""
    for _ in range(limit):
        outcome = action.poll()
        if outcome is not None:
            return outcome
        world.advance()
    raise AssertionError(f"no outcome within {limit} ticks")


def drive(world: World, left_m: float, right_m: float) -> Outcome[Any]:
    """Drive the belts at full speed to the end."""
    return finish(world, world.tracks.drive(left_m, right_m, 0.0014))


def heading(rotation: Array) -> float:
    """Heading of a rotation R_site_body [rad]."""
    return math.atan2(float(rotation[1, 0]), float(rotation[0, 0]))


def travel(before: Array, after: Array) -> float:
    """Distance between two positions [m]."""
    return float(np.linalg.norm(after - before))
