"""What a simulation or a robot registers under `longarm.backends`."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from pydantic import BaseModel

from executive.config.source import Place
from executive.core.ports import Backend
from executive.core.registry import Kind
from executive.core.rig import Rig
from executive.core.types import Segment


@dataclass(frozen=True)
class BackendRequest:
    """All that a backend is told: nothing of the tree, nothing of the expectations.

    `world` is an instance of the backend's own `world_model`, `rig` one of its own rig; `route` is the plan
    as ground uplinked it; `truth_path` is where a simulation writes its truth (None: nowhere);
    `tick_s` the length of a tick [s].
    """

    world: BaseModel
    route: tuple[Segment, ...]
    seed: int
    tier: str
    rig: Rig
    truth_path: Path | None
    tick_s: float


@dataclass(frozen=True)
class WorldProblem:
    """Why a well-formed world cannot be made; `place` are the keys, seen from `world`, that say so.

    With `waypoint` the problem is reported at that way-point of the mission instead, counted from 0. A
    `warning` tells what may come of a world that can be made.
    """

    place: Place
    message: str
    waypoint: int | None = None
    warning: bool = False


def no_problems(world: BaseModel, route: tuple[Segment, ...]) -> tuple[WorldProblem, ...]:
    """The `problems` of a backend that can make every world its schema allows."""
    return ()


def nothing_to_load() -> None:
    """The `preload` of a backend that is all there once it is registered."""


@dataclass(frozen=True)
class BackendSpec:
    """A backend by name: its world's schema, the tiers it can play, its devices, and how to make one.

    `devices` are names of registered devices, one of them a drive: what trees need is held against them.
    `rig` is a frozen dataclass whose fields all have defaults; a scenario's `rig:` may replace each of them.

    `strategies` are those made for it, by name (None: any whose devices it has).

    `problems` tells, before anything is made or written, why a world cannot be made for a route. `preload`
    imports what `create` needs, for a process that is about to make many.
    """

    name: str
    doc: str
    world_model: type[BaseModel]
    tiers: tuple[str, ...]
    devices: tuple[str, ...]
    rig: type[Rig]
    create: Callable[[BackendRequest], Backend]
    strategies: tuple[str, ...] | None = None
    problems: Callable[[BaseModel, tuple[Segment, ...]], tuple[WorldProblem, ...]] = no_problems
    preload: Callable[[], None] = nothing_to_load


def _broken(spec: BackendSpec) -> Iterator[str]:
    if not spec.doc.strip():
        yield "it does not say what it is"
    if not spec.tiers:
        yield "it plays no tier"


BACKEND_KIND: Kind[BackendSpec] = Kind(
    "backend", "backends", "A robot, simulated or real.", BackendSpec, check=_broken
)
