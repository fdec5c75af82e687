"""What writes the report of a folder that is not a run's."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from executive.core.registry import Kind


@dataclass(frozen=True)
class Reporter:
    """Named by the file that marks its folders (`campaign` for campaign.json); `write` returns the report."""

    name: str
    doc: str
    write: Callable[[Path], Path]


REPORTER_KIND: Kind[Reporter] = Kind(
    "reporter", "reporters", "What writes the report of a kind of folder.", Reporter
)
