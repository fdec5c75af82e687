"""The `result.json` of a case: that of its run, and how the campaign came to it and judged it."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from functools import cache
from pathlib import Path

from pydantic import TypeAdapter, ValidationError

from executive.core.errors import RecordError
from executive.core.files import write_whole
from executive.record import RunResult


@dataclass(frozen=True)
class CaseNote:
    """What the campaign says of a case: what it drew, its verdict, and what caused the ending (`class_`)."""

    index: int
    setting: str = ""
    verdict: str | None = None
    message: str = ""
    class_: str = ""
    cause: str = ""
    detail: str = ""
    draw: int = 0
    attempts: int = 1
    wall_s: float = 0.0
    memory_bytes: int = 0
    drawn: Mapping[str, str] = field(default_factory=dict)
    journal: Mapping[str, object] = field(default_factory=dict)
    """The line of the campaign's journal."""


_ORDER = (
    *("index", "draw", "setting", "verdict", "message", "class", "cause", "detail"),
    *("attempts", "wall_s", "memory_bytes", "drawn", "journal"),
)


@dataclass(frozen=True)
class CaseResult:
    """A run and what the campaign says of it; None where no campaign has judged it."""

    run: RunResult
    case: CaseNote | None = None

    def to_json(self) -> dict[str, object]:
        """The keys of a run's result, and `case`."""
        if self.case is None:
            return self.run.to_json()
        note = {key.rstrip("_"): value for key, value in asdict(self.case).items()}
        return self.run.to_json() | {"case": {key: note[key] for key in _ORDER}}

    @classmethod
    def from_json(cls, data: object) -> CaseResult:
        """What plain data stand for; RecordError if it is no result of a run."""
        note = data.get("case") if isinstance(data, dict) else None
        run = RunResult.from_json(data)
        if not isinstance(note, dict):
            return cls(run)
        known = {("class_" if key == "class" else key): value for key, value in note.items()}
        try:
            return cls(run, _adapter().validate_python({k: v for k, v in known.items() if v is not None}))
        except ValidationError as error:
            raise RecordError(
                f"not a case of a campaign: {error.errors(include_url=False)[0]['msg']}"
            ) from None


@cache
def _adapter() -> TypeAdapter[CaseNote]:
    return TypeAdapter(CaseNote)


def read_case(path: Path) -> CaseResult:
    """The `result.json` of a case; RecordError where it cannot be read. OSError where there is none."""
    try:
        return CaseResult.from_json(json.loads(path.read_text()))
    except ValueError as error:
        raise RecordError(f"{path}: not JSON: {error}") from None


def write_case(path: Path, result: CaseResult) -> None:
    """Write strictly valid JSON, with a newline at the end."""
    write_whole(path, json.dumps(result.to_json(), indent=2, allow_nan=False) + "\n")
