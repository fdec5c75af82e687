"""The shape of a scenario's `expect`: what its run must come to. What is not said is not judged."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal, Self

from pydantic import AfterValidator, Field, model_validator
from pydantic_core import PydanticCustomError

from executive.config.models import Name
from executive.config.source import Source
from executive.config.validate import Strict, guess, listed
from executive.core.types import Reason
from executive.core.units import (
    Angle,
    Duration,
    Force,
    Length,
)

FormulaText = Annotated[str, Field(min_length=1, max_length=1000)]
ENDS = ("success", "failure", "halted", *(str(r) for r in Reason if r is not Reason.DONE))
"""How a node can end; a failure also by its reason."""
OutcomeName = Literal["reached", "safe_hold", "help", "time_limit", "error"]


class Below(Strict):
    below: Length


class BelowAngle(Strict):
    below: Angle


class BelowForce(Strict):
    below: Force


class AtLeast(Strict):
    at_least: Annotated[int, Field(ge=0)]


class Noticed(Strict):
    """The named fault, and how soon after it took effect."""

    fault: Name
    within: Duration | None = None


class Diagnosed(Noticed):
    """The named fault must be recognised `as` a hypothesis within this time of its taking effect."""

    as_: Annotated[Name, Field(alias="as")]


class Bounded(Strict):
    """Something with two fields that bound it, of which at least one must be said."""

    BOUNDS: ClassVar[tuple[str, str]] = ("above", "below")

    @model_validator(mode="after")
    def bounded(self) -> Self:
        if not self.model_fields_set & set(self.BOUNDS):
            raise _wrong(f"got no bound, expected {', '.join(self.BOUNDS)} or both")
        return self


class LengthBand(Bounded):
    above: Length | None = None
    below: Length | None = None


class DurationBand(Bounded):
    above: Duration | None = None
    below: Duration | None = None


def _known_end(word: str) -> str:
    if word not in ENDS:
        raise _wrong(f'got "{word}", expected {listed(ENDS)}{guess(word, ENDS)}')
    return word


def _wrong(text: str) -> PydanticCustomError:
    return PydanticCustomError("located", "{text}", {"text": text})


Ends = Annotated[str, AfterValidator(_known_end), Field(json_schema_extra={"enum": list(ENDS)})]
Step = Annotated[dict[Name, Ends], Field(min_length=1, max_length=1)]
"""A node, by its name or path, and how it ends: {localise: not_seen}."""


class Times(Bounded):
    """How often a node may end in one way."""

    BOUNDS = ("at_least", "at_most")

    of: Step
    at_least: Annotated[int, Field(ge=0)] = 0
    at_most: Annotated[int, Field(ge=0)] | None = None


class Expect(Strict):
    """Every field that takes a list also takes what would be its only member."""

    outcome: tuple[OutcomeName, ...] = ()
    mission_time: DurationBand | None = None
    path: LengthBand | None = None
    final_error: Below | None = None
    driven_beyond_off_track: Below | None = None
    max_cross_track: Below | None = None
    max_tilt: BelowAngle | None = None
    max_tether: BelowForce | None = None
    at_rest: Literal[True] | None = None
    waypoints_reached: AtLeast | None = None
    detected: tuple[Noticed, ...] = ()
    diagnosed: tuple[Diagnosed, ...] = ()
    recovered: tuple[Noticed, ...] = ()
    strategies_tried: tuple[Name, ...] = ()
    strategies_not_tried: tuple[Name, ...] = ()
    in_order: tuple[Step, ...] = ()
    never: tuple[Step, ...] = ()
    times: tuple[Times, ...] = ()
    always: tuple[FormulaText, ...] = ()
    eventually: tuple[FormulaText, ...] = ()
    until: tuple[FormulaText, ...] = ()
    holds: tuple[FormulaText, ...] = ()


class JudgeKeys(Strict):
    """What a scenario says of how its run is judged.

    `expected_to_fail` says why the expectations do not hold yet; the run's safety must, all the same.
    """

    expect: Expect = Expect()
    expected_to_fail: Annotated[str, Field(min_length=1, max_length=500)] | None = None


LISTS_OF_STEPS = ("in_order", "never", "times")
LISTS = tuple(name for name, field in Expect.model_fields.items() if field.default == ())


def with_lists(source: Source) -> Source:
    """The source of a scenario, every single value where `expect` takes a list made the list of it."""
    expect = source.data.get("expect") if isinstance(source.data, dict) else None
    for name in LISTS:
        if isinstance(expect, dict) and not isinstance(expect.get(name, []), list):
            source = source.only_member(("expect", name))
    return source
