"""What a fault plug-in registers under `longarm.faults`, and when a fault starts. No implementation here."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Self

from pydantic import BaseModel, Field, model_validator
from pydantic_core import PydanticCustomError

from executive.config.validate import Strict
from executive.units import Duration, Fraction


@dataclass(frozen=True)
class FaultSpec:
    """A kind of fault: its parameters' schema, and where it can act (empty: everywhere)."""

    name: str
    doc: str
    model: type[BaseModel]
    backends: tuple[str, ...] = ()
    tiers: tuple[str, ...] = ()


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
