"""What a fault plug-in registers under `longarm.faults`: what a fault may alter, and its evidence.

The shapes alone: the core runs no fault and knows none by name. They stand here because packages that may not
import each other (a simulation, the faults of the ports) register faults.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from pydantic import BaseModel

from executive.config.describe import parameters, properties
from executive.config.validate import guess, listed
from executive.core import registry
from executive.core.clock import Clock
from executive.core.ports import Backend, Devices, Localizer
from executive.core.registry import Kind
from executive.isc import hypothesis_names
from executive.pool import Strategy
from executive.record.events import Placed
from executive.run.instrument import TreeParts

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

    def placed(self) -> tuple[Placed, ...]:
        """What it has lying in the world just now, for the map of the report; asked once a tick."""
        return ()

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

    @property
    def profiles(self) -> tuple[str, ...]:
        """The profiles that it may have, by the words that a scenario uses."""
        passing = () if self.lasting else ("intermittent", "random")
        return ("step", *(("ramp",) if self.graded else ()), *passing)


def broken_promises(spec: FaultSpec) -> Iterator[str]:
    """A sentence for each promise that a fault's declaration breaks."""
    if not spec.doc.strip():
        yield "it does not say what happens (doc)"
    known = hypothesis_names()
    if spec.hypothesis and spec.hypothesis not in known:
        expected = f"expected {listed(known)}{guess(spec.hypothesis, known)}"
        yield f'unknown hypothesis "{spec.hypothesis}", {expected}'
    for role in ("node", "value", "strategy"):
        parameter = getattr(spec, role)
        if parameter is not None and parameter not in spec.model.model_fields:
            yield f"its {role} is the parameter {parameter!r}, which {spec.model.__name__} does not have"


def page(spec: FaultSpec) -> dict[str, Any]:
    """What a scenario may say of a fault, where it acts, and what it should lead to."""
    return {
        "category": spec.category,
        "doc": spec.doc,
        "parameters": [asdict(parameter) for parameter in parameters(spec.model)],
        "profiles": list(spec.profiles),
        "lasting": spec.lasting,
        "tiers": list(spec.tiers),
        "backends": list(spec.backends),
        "hypothesis": spec.hypothesis,
        "model": properties(spec.model),
    }


FAULT_KIND: Kind[FaultSpec] = Kind(
    "fault", "faults", "What can go wrong, injected.", FaultSpec, check=broken_promises, page=page
)


def load_fault(name: str) -> FaultSpec:
    """The kind of fault registered under this name; PluginError if it is broken. KeyError: no such name."""
    return registry.get(FAULT_KIND, name)


def every_fault() -> tuple[FaultSpec, ...]:
    """All that can be used, by name."""
    return tuple(registry.every(FAULT_KIND).values())
