"""How a case fails: the first thing that is violated, so that two failures can be told to be the same."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace

from executive.record import RunResult, first_violated
from executive.run import ResolvedScenario
from proving.engine import CaseClass, Ending
from proving.judge import INSTRUMENT as JUDGE

_EXCEPTION = re.compile(r"\b([A-Z]\w*(?:Error|Exception|Exit|Interrupt)|\w+Broken)\b")


_NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?")
_PATH = re.compile(r"\w+(?:/[\w#]+)+")
PARTS = ("end", "reason", "hypothesis", "place")


@dataclass(frozen=True)
class Failure:
    """`kind` is unsafe, expectation, outcome, invalid or error; `text` says what, without times.

    The rest is its signature: how the run ended and for what reason, with `#` for each number; the node that
    the reason names; and the hypothesis that was held likeliest when a strategy was last asked for.
    """

    kind: str
    text: str
    end: str = ""
    reason: str = ""
    hypothesis: str = ""
    place: str = ""

    def __str__(self) -> str:
        return f"{self.kind}: {self.text}"

    def is_as(self, other: Failure | None, loosely: bool = False) -> bool:
        """Whether both are the same failure: in their whole signature, or `loosely` in kind and text."""
        if other is None or (self.kind, self.text) != (other.kind, other.text):
            return False
        return loosely or not tuple(self.differences(other))

    def differences(self, other: Failure) -> Iterator[str]:
        """In what the signature of another differs, each in a few words."""
        for part in PARTS:
            mine, its = getattr(self, part), getattr(other, part)
            if mine != its:
                yield f"{part} {its or 'none'}, not {mine or 'none'}"


def failure_of(ending: Ending, result: RunResult, scenario: ResolvedScenario) -> Failure | None:
    """The failure of a case that has ended; None if it is as it should be."""
    found = _violated(ending, result, scenario)
    return None if found is None else signed(found, result)


def signed(failure: Failure, result: RunResult) -> Failure:
    """The failure with the signature that the result of its run gives."""
    reason = result.reason or ""
    place = _PATH.search(reason)
    concluded = result.strategies[-1].hypothesis if result.strategies else ""
    return replace(
        failure,
        end=result.outcome,
        reason=_NUMBER.sub("#", _PATH.sub("", reason)),
        hypothesis=concluded,
        place=place[0] if place else "",
    )


def _violated(ending: Ending, result: RunResult, scenario: ResolvedScenario) -> Failure | None:
    if ending.kind in (CaseClass.INFRASTRUCTURE, CaseClass.REFUSED):
        return Failure(str(ending.kind), ending.cause)
    if result.outcome == "error" and not _allowed(scenario):
        return Failure("error", _what(ending, str(result.reason)))
    if result.outcome == "invalid":
        return Failure("invalid", str(result.reason).split(" never ")[0])
    for kind, rows in (("unsafe", result.safety or ()), ("expectation", result.expectations)):
        first = first_violated(rows)
        if first is not None:
            return Failure(kind, first.text)
    if not result.expectations and result.outcome != "reached":
        return Failure("outcome", str(result.outcome))
    return None


def _allowed(scenario: ResolvedScenario) -> bool:
    return "error" in scenario.of(JUDGE).expect.outcome


def _what(ending: Ending, reason: str) -> str:
    """A hang is a hang; a defect is known by its exception."""
    if ending.cause and ending.cause != "error":
        return ending.cause
    raised = _EXCEPTION.search(reason)
    return raised[1] if raised else reason
