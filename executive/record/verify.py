"""`longarm verify-record`: all that can be said against the records of a run folder."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from executive.core.errors import LongarmError, RecordError
from executive.record.digest import digest
from executive.record.history import History
from executive.record.integrity import RECORDS, SUMS, damage
from executive.record.reader import is_complete
from executive.record.run_result import read_result


@dataclass(frozen=True)
class Verified:
    """What was found: `problems` against the records, empty where they are what was written."""

    folder: Path
    problems: tuple[str, ...]


def verify(folder: Path) -> Verified:
    """Check sums, closing marks, and the digest that the result gives; RecordError where there is no run."""
    if not (folder / RECORDS[0]).is_file():
        raise RecordError(f"{folder}: got no {RECORDS[0]}, expected a run folder")
    problems = []
    for name in RECORDS:
        path = folder / name
        if not path.is_file():
            continue
        damaged = [f"{name}: damaged: {each}" for each in damage(path)]
        problems += damaged
        if not damaged and not is_complete(path):
            problems.append(f"{name}: incomplete: it was not closed, and ends at {_end(path)}")
    if not problems:
        problems += _against_the_result(folder)
    return Verified(folder, tuple(problems))


def _end(path: Path) -> str:
    end_s = History.of(path).end_s
    return f"{end_s:.0f} s of mission time"


def _against_the_result(folder: Path) -> list[str]:
    try:
        written = read_result(folder / "result.json").digest
    except LongarmError as error:
        return [f"result.json: {error}"]
    problems = [] if (folder / SUMS).is_file() else [f"{SUMS} is missing"]
    if digest(folder / RECORDS[0]) != written:
        problems.append(f"{RECORDS[0]}: its digest is not that of result.json")
    return problems
