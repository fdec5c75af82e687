"""The files that a run is recorded in: new ones, or those of a run that was cut off."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass
from pathlib import Path
from typing import Generic, TypeVar

from executive.record.continuation import Continuation, beside, cut_ticks
from executive.record.recorder import Recorder
from executive.run.cuts import Cuts

RECORD, TRUTH = "record.mcap", "truth.mcap"


R = TypeVar("R", bound=Recorder, covariant=True)


@dataclass(frozen=True)
class Recording(Generic[R]):
    """Where a run is recorded, and the cuts of it."""

    recorder: R
    truth_path: Path
    cuts: Cuts
    settle: Callable[[], None] = lambda: None
    """Put the truth in its place, where it was not there yet as the record took its own."""


def fresh(folder: Path, cut_ticks: Collection[int] = ()) -> Recording[Recorder]:
    """The files of a run that begins; one that repeats another is cut where that was."""
    return Recording(Recorder(folder / RECORD), folder / TRUTH, Cuts(cut_ticks))


def continued(folder: Path) -> Recording[Continuation]:
    """The files of a run that was cut off: each is written anew beside itself until it holds as much."""
    truth, record = folder / TRUTH, folder / RECORD

    def take_place() -> None:
        if beside(truth).is_file():
            beside(truth).replace(truth)

    ticks = cut_ticks(record)
    recorder = Continuation(record, take_place)
    return Recording(recorder, beside(truth), Cuts(ticks, lambda: not recorder.behind), take_place)
