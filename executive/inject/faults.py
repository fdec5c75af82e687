"""What a fault plug-in registers under `longarm.faults`: what a fault may alter, and its evidence.

No implementation here, and nothing else in the core knows a fault by name.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, MutableMapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from py_trees.behaviour import Behaviour
from pydantic import BaseModel

from executive.core.clock import Clock
from executive.core.ports import Backend, Devices, Localizer
from executive.core.types import Outcome
from executive.pool import Strategy

CATEGORIES = (
    *("tracks", "terrain", "tether", "head", "cameras", "markers", "light"),
    *("estimation", "link", "executive", "other"),
)


@dataclass(frozen=True)
class Cue:
    """What a fault may ask while the run goes on: how strong it is just now, the time, its own chance.

    `level` is 0 while the fault is not there, 1 at full severity, between them along a ramp.
    """

    level: Callable[[], float]
    clock: Clock
    rng: np.random.Generator

    @property
    def active(self) -> bool:
        return self.level() > 0.0


@dataclass(frozen=True)
class TreeParts:
    """What a fault of the executive may reach: every node by its path (outermost behaviour), the values.

    `fail` says in a node's stead that it has failed, and why.
    """

    nodes: Mapping[str, Behaviour]
    values: MutableMapping[str, object]
    fail: Callable[[str, Outcome[object]], None] = lambda path, outcome: None


class Fault:
    """One injected fault. Override what it acts through: ports, localizer, tree, pool or the world.

    What is wrapped asks its cue each time it is used; it is wrapped once, before the run.
    """

    def wrap(self, devices: Devices, cue: Cue) -> Devices:
        """The devices as the executive shall see them."""
        return devices

    def wrap_localizer(self, localizer: Localizer, cue: Cue) -> Localizer:
        """The localizer as the executive shall see it."""
        return localizer

    def wrap_tree(self, tree: TreeParts, cue: Cue) -> None:
        """Alter the behaviours of the built tree, in place."""

    def wrap_pool(self, strategies: tuple[Strategy, ...], cue: Cue) -> tuple[Strategy, ...]:
        """The strategies as the executive shall find them when it starts."""
        return strategies

    def apply(self, backend: Backend, level: float) -> None:
        """Change the world; called whenever the level has changed, the last time with 0."""

    def watch(self, backend: Backend) -> None:
        """Look for evidence; called once a tick while active."""

    def took_effect(self) -> bool:
        """Evidence: whether anything has gone otherwise because of it since its onset."""
        return True


@dataclass(frozen=True)
class FaultSpec:
    """A kind of fault: its parameters' schema, how to make one, the diagnosis it should lead to.

    `make` is given an instance of `model`. `backends` and `tiers` say where it can act (empty: everywhere).
    A `lasting` fault cannot be taken back, so that `for` is refused; a `graded` one knows levels between 0
    and 1, so that it may come as a ramp. `node`, `value` and `strategy` name the parameters that must name a
    node or a value of the tree, or a strategy of the pool. `hypothesis` is empty where there is nothing for
    the classification to find.
    """

    name: str
    doc: str
    model: type[BaseModel]
    make: Callable[[Any], Fault]
    hypothesis: str
    backends: tuple[str, ...] = ()
    tiers: tuple[str, ...] = ()
    lasting: bool = False
    category: str = "other"
    graded: bool = False
    node: str | None = None
    value: str | None = None
    strategy: str | None = None

    def __post_init__(self) -> None:
        if self.category not in CATEGORIES:
            raise ValueError(f"{self.name}: got the category {self.category!r}, expected one of {CATEGORIES}")
