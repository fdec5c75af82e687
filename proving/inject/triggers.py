"""When a fault begins, as a file says it."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from executive.config.validate import Strict
from executive.core.units import Duration, Fraction

ONSETS = ("time", "progress", "waypoint", "node", "strategy", "phase", "when")
COUNTED = ("node", "strategy", "phase")
PHASES = ("localising", "turning", "driving", "recovering", "calling")

Word = Annotated[str, Field(min_length=1)]


class Trigger(Strict):
    """When a fault begins: exactly one onset; `count` goes with what can be entered, the rest with `when`."""

    time: Annotated[Duration, Field(ge=0)] | None = None
    progress: Annotated[Fraction, Field(ge=0, le=1)] | None = None
    waypoint: Annotated[int, Field(ge=0)] | None = None
    node: Word | None = None
    strategy: Word | None = None
    phase: Literal["localising", "turning", "driving", "recovering", "calling"] | None = None
    when: Word | None = None
    count: Annotated[int, Field(ge=1)] | None = None
    edge: Literal["rise", "fall"] | None = None
    held: Annotated[Duration, Field(gt=0)] | None = None

    @model_validator(mode="after")
    def one_of_them(self) -> Self:
        named = [name for name in ONSETS if getattr(self, name) is not None]
        if len(named) != 1:
            got = " and ".join(named) if named else "none"
            raise _wrong(f"got {got}, expected exactly one of {', '.join(ONSETS)}")
        if self.count is not None and named[0] not in COUNTED:
            raise _wrong(f"got count with {named[0]}, expected it with one of {', '.join(COUNTED)}")
        for extra in ("edge", "held"):
            if getattr(self, extra) is not None and self.when is None:
                raise _wrong(f"got {extra} with {named[0]}, expected it with when")
        return self


def _wrong(text: str) -> PydanticCustomError:
    return PydanticCustomError("located", "{text}", {"text": text})
