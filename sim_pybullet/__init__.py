"""Rover, terrain, head and cameras in PyBullet, behind the ports that hardware would answer."""

from __future__ import annotations

from pydantic import BaseModel

from executive.config.backends import BackendRequest, BackendSpec, WorldProblem
from executive.core.ports import Backend
from executive.core.rig import RigCalibration
from executive.core.types import Segment
from sim_pybullet.config import WorldConfig

__all__ = ["BACKEND"]


def _create(request: BackendRequest) -> Backend:
    """PyBullet, OpenCV and the rest are imported only when a world is made, not to list or validate."""
    from sim_pybullet.backend import create

    return create(request)


def _problems(world: BaseModel, route: tuple[Segment, ...]) -> tuple[WorldProblem, ...]:
    from sim_pybullet.world_check import world_problems

    return world_problems(world, route)


def _preload() -> None:
    import sim_pybullet.backend
    import sim_pybullet.world_check  # noqa: F401  (imported for the next to find)


BACKEND = BackendSpec(
    name="pybullet",
    doc="The rover, the ground and the lander's head in PyBullet, with images in linear radiometry.",
    world_model=WorldConfig,
    tiers=("full", "geometric"),
    devices=("tracks", "cabin", "head", "cameras", "inclinometer", "tether", "link"),
    rig=RigCalibration,
    create=_create,
    problems=_problems,
    preload=_preload,
)
