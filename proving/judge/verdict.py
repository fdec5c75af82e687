"""What a run says about its scenario: one word, one line, and the command that repeats it."""

from __future__ import annotations

import shlex
from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum

from executive.record import JudgedRow, RunResult, first_violated
from executive.run import ResolvedScenario
from proving.engine import Case, CaseClass, Ending
from proving.judge.instrument import INSTRUMENT


class Word(StrEnum):
    """The verdicts, best first."""

    PASSED = "passed"
    EXPECTED_FAILURE = "expected failure"
    FAILED = "failed"
    INVALID = "invalid"
    """A fault never took effect, so that the run proves nothing."""
    ERROR = "error"


GOOD = (Word.PASSED, Word.EXPECTED_FAILURE)


@dataclass(frozen=True)
class Verdict:
    """A word and, unless it passed, one line that says why."""

    word: Word
    message: str = ""

    @property
    def good(self) -> bool:
        return self.word in GOOD


@dataclass(frozen=True)
class Terms:
    """What a scenario says beside its expectations about how to judge it."""

    error_expected: bool = False
    expected_to_fail: str | None = None

    @classmethod
    def of(cls, scenario: ResolvedScenario) -> Terms:
        """The terms of a scenario."""
        judged = scenario.of(INSTRUMENT)
        return cls("error" in judged.expect.outcome, judged.expected_to_fail)


def judged(ending: Ending, result: RunResult, terms: Terms) -> Verdict:
    """The verdict on a case that has ended.

    Safety rows hold for every run; where the failure is expected, it must come, and be one of expectations.
    """
    if ending.kind in (CaseClass.INFRASTRUCTURE, CaseClass.REFUSED):
        return Verdict(Word.ERROR, _one_line(f"{ending.kind}, {ending.cause}: {ending.detail}"))
    if result.outcome == "error" and not terms.error_expected:
        said = f"{ending.cause}: {ending.detail}" if ending.cause else str(result.reason)
        return Verdict(Word.ERROR, _one_line(said))
    if result.outcome == "invalid":
        return Verdict(Word.INVALID, str(result.reason))
    if unsafe := first_violation(result.safety or (), result):
        return Verdict(Word.FAILED, f"unsafe: {unsafe}")
    broken = _broken(result)
    if terms.expected_to_fail is None:
        return Verdict(Word.FAILED, broken) if broken else Verdict(Word.PASSED)
    if broken:
        return Verdict(Word.EXPECTED_FAILURE, terms.expected_to_fail)
    return Verdict(Word.FAILED, f"passed, though expected to fail: {terms.expected_to_fail}")


def _broken(result: RunResult) -> str:
    if result.expectations:
        return first_violation(result.expectations, result)
    if result.outcome == "reached":
        return ""
    why = f", {result.reason}" if result.reason else ""
    return f"ended {result.outcome} at {result.mission_s:.0f} s{why}"


def first_violation(rows: Iterable[JudgedRow], result: RunResult) -> str:
    """The row that was violated first: what, when, by how much. Nothing if all hold or are not known."""
    row = first_violated(rows)
    if row is None:
        return ""
    when_s = result.mission_s if row.t_violation_s is None else row.t_violation_s
    margin = f" (robustness {row.robustness:.3g})" if isinstance(row.robustness, float) else ""
    ended = f"; ended {result.outcome}" + (f", {result.reason}" if result.reason else "")
    return f"{row.text}: not met at {when_s:.0f} s{margin}{ended}"


def repeat_command(case: Case, seed: int) -> str:
    """What to type to run a scenario file's case again by itself."""
    words = ["longarm", "run", str(case.file), "--seed", str(seed)]
    words += ["--tier", case.tier] if case.tier else []
    for text in case.overrides:
        words += ["--set", text]
    return shlex.join(words)


def _one_line(text: str) -> str:
    return " ".join(text.split())
