"""What every fault of the simulated world shares: how it acts, and how it shows that it has."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from pydantic import BaseModel, ConfigDict

from executive.core.errors import LongarmError
from executive.core.ports import Backend
from executive.run import Fault, FaultSpec

if TYPE_CHECKING:
    from sim_pybullet.world_faults import WorldActivity, WorldFaults


class Parameters(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Nothing(Parameters):
    """No parameters."""


P = TypeVar("P", bound=Parameters)


class WorldFault(Fault, Generic[P]):
    """Acts on the world by level; evidence is what was done there while it was active, not that it was on.

    Subclasses write `act` (at each change of level, 0 puts the world right again), `shows`, and `step`
    where they change from tick to tick.
    """

    def __init__(self, parameters: P) -> None:
        self.p = parameters
        self.level = 0.0
        self._since: WorldActivity | None = None
        self._shown = False

    def apply(self, backend: Backend, level: float) -> None:
        sim = _simulation(backend)
        if self.level == 0.0:
            self._since = sim.tally()
        self.level = float(level)
        self.act(sim, self.level)

    def watch(self, backend: Backend) -> None:
        sim = _simulation(backend)
        if self._since is not None and not self._shown:
            self._shown = self.shows(sim, sim.tally().since(self._since))
        self.step(sim)

    def took_effect(self) -> bool:
        return self._shown

    def act(self, sim: WorldFaults, level: float) -> None:
        """Bring the world into the state of this level."""
        raise TypeError(f"{type(self).__name__} does nothing")

    def step(self, sim: WorldFaults) -> None:
        """Go on; once a tick while active."""

    def shows(self, sim: WorldFaults, done: WorldActivity) -> bool:
        """Whether anything goes otherwise by now; `done` is what was done since it became active."""
        raise TypeError(f"{type(self).__name__} has no evidence")


def spec(
    name: str,
    fault: type[WorldFault[Any]],
    parameters: type[Parameters],
    hypothesis: str | None,
    category: str,
    graded: bool = False,
    lasting: bool = False,
) -> FaultSpec:
    """How a fault of the simulation is registered; it is told of by its class's documentation."""
    make: Callable[[Any], Fault] = fault
    doc = " ".join((fault.__doc__ or "").split())
    return FaultSpec(
        name,
        doc,
        parameters,
        make,
        hypothesis or "",
        backends=("pybullet",),
        tiers=("full", "geometric"),
        lasting=lasting,
        category=category,
        graded=graded,
    )


def _simulation(backend: Backend) -> WorldFaults:
    from sim_pybullet.backend import SimBackend

    if not isinstance(backend, SimBackend):
        raise LongarmError(f"got a backend of type {type(backend).__name__}, expected the simulation")
    return backend.world_faults
