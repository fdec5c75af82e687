"""What a run came to, to be held against another run of the same scenario."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from proving.engine import Ending, settle
from proving.judge.verdict import Terms, Verdict, Word, judged

IDENTITY = ("digest", "wall", "wall_s", "case")
"""What differs between two runs that did the same, told by their texts and clocks alone."""
NO_EXPECTATION = (Word.INVALID, Word.ERROR)


@dataclass(frozen=True)
class Account:
    """The verdict, the expectations and safety rows met and missed by their texts, all measures."""

    verdict: Verdict
    met: frozenset[str]
    missed: tuple[str, ...]
    behaviour: Mapping[str, Any]

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
    rows = [*(result.get("safety") or ()), *result["expectations"]]
    return Account(
        judged(ending, result, terms),
        frozenset(str(row["text"]) for row in rows if row["met"] is True),
        tuple(str(row["text"]) for row in rows if row["met"] is False),
        {key: value for key, value in result.items() if key not in IDENTITY},
    )
