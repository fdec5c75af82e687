"""How a case fails: the first thing that is violated, so that two failures can be told to be the same."""

from __future__ import annotations

import re
from dataclasses import dataclass

from executive.record import RunResult, first_violated
from executive.run import ResolvedScenario
from proving.engine import CaseClass, Ending
from proving.judge import INSTRUMENT as JUDGE

_EXCEPTION = re.compile(r"\b([A-Z]\w*(?:Error|Exception|Exit|Interrupt)|\w+Broken)\b")


@dataclass(frozen=True)
class Failure:
    """`kind` is unsafe, expectation, outcome, invalid or error; `text` says what, without times."""

    kind: str
    text: str

    def __str__(self) -> str:
        return f"{self.kind}: {self.text}"


def failure_of(ending: Ending, result: RunResult, scenario: ResolvedScenario) -> Failure | None:
    """The failure of a case that has ended; None if it is as it should be."""
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
