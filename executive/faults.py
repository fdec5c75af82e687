"""What a fault plug-in registers under `longarm.faults`, and when a fault starts. No implementation here."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any, Self

from pydantic import BaseModel, Field, model_validator
from pydantic_core import PydanticCustomError

from executive.config.validate import Strict
from executive.ports import Backend, Devices
from executive.units import Duration, Fraction


class Fault:
    """One injected fault. Override `wrap` for a fault of the ports, `apply` for one of the world, or both."""

    def wrap(self, devices: Devices, active: Callable[[], bool]) -> Devices:
        """The devices as the executive shall see them; what is wrapped asks `active` whenever it is used."""
        return devices

    def apply(self, backend: Backend, active: bool) -> None:
        """Change the world at the onset, and back at the end."""

    def took_effect(self) -> bool:
        """Evidence: whether anything has gone otherwise because of it since its onset.

        A fault of the world has by its onset alone; one of the ports once an answer was altered.
        """
        return True


@dataclass(frozen=True)
class FaultSpec:
    """A kind of fault: its parameters' schema, how to make one, the diagnosis it should lead to.

    `make` is given an instance of `model`. `backends` and `tiers` say where it can act (empty: everywhere).
    A `lasting` fault cannot be taken back, so that `for` is refused.
    """

    name: str
    doc: str
    model: type[BaseModel]
    make: Callable[[Any], Fault]
    hypothesis: str
    backends: tuple[str, ...] = ()
    tiers: tuple[str, ...] = ()
    lasting: bool = False


class Trigger(Strict):
    """When a fault begins: exactly one of these, `count` going with `node`."""

    time: Annotated[Duration, Field(ge=0)] | None = None
    progress: Annotated[Fraction, Field(ge=0, le=1)] | None = None
    waypoint: Annotated[int, Field(ge=0)] | None = None
    node: Annotated[str, Field(min_length=1)] | None = None
    count: Annotated[int, Field(ge=1)] | None = None
    strategy: Annotated[str, Field(min_length=1)] | None = None
    when: Annotated[str, Field(min_length=1)] | None = None

    @model_validator(mode="after")
    def one_of_them(self) -> Self:
        named = [name for name in ONSETS if getattr(self, name) is not None]
        if len(named) != 1:
            got = " and ".join(named) if named else "none"
            text = f"got {got}, expected exactly one of {', '.join(ONSETS)}"
            raise PydanticCustomError("located", "{text}", {"text": text})
        if self.count is not None and self.node is None:
            text = "got count without node, expected {node: NAME, count: N}"
            raise PydanticCustomError("located", "{text}", {"text": text})
        return self


ONSETS = ("time", "progress", "waypoint", "node", "strategy", "when")
