"""What can be covered: an outcome of a node, what became of a strategy, a phase, a fault, a hypothesis."""

from __future__ import annotations

from dataclasses import dataclass

KINDS = ("node", "strategy", "phase", "fault", "hypothesis")


@dataclass(frozen=True, order=True)
class Item:
    """One thing that a run may show. `name` of a node is its path inside its own tree file."""

    kind: str
    name: str
    word: str

    def __str__(self) -> str:
        return f"{self.kind} {self.name}: {self.word}"
