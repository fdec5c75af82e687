"""What a run came to, to be held against another run of the same scenario."""

from __future__ import annotations

from dataclasses import dataclass, replace

from executive.record import RunResult
from proving.engine import Ending, settle
from proving.judge.verdict import Terms, Verdict, Word, judged

NO_EXPECTATION = (Word.INVALID, Word.ERROR)


@dataclass(frozen=True)
class Account:
    """The verdict, the expectations and safety rows met and missed by their texts, all measures."""

    verdict: Verdict
    met: frozenset[str]
    missed: tuple[str, ...]
    behaviour: RunResult
    """The result but for what differs between two runs that did the same, told by texts and clocks alone."""

    def lost(self, before: Account) -> str | None:
        """The first thing that held `before` and no longer does, None if all still does."""
        gone = [*(text for text in self.missed if text in before.met), *sorted(before.met - self.known)]
        worse = self.verdict.word in NO_EXPECTATION and before.verdict.word not in NO_EXPECTATION
        if worse or (before.verdict.good and not self.verdict.good and not gone):
            return f"{self.verdict.word}: {self.verdict.message}"
        return gone[0] if gone else None

    @property
    def known(self) -> frozenset[str]:
        return self.met | frozenset(self.missed)


def account(ending: Ending, terms: Terms) -> Account:
    """The account of a case that has ended."""
    result = settle(ending)
    rows = [*(result.safety or ()), *result.expectations]
    return Account(
        judged(ending, result, terms),
        frozenset(row.text for row in rows if row.met is True),
        tuple(row.text for row in rows if row.met is False),
        replace(result, digest="", wall={}, wall_s=None),
    )
