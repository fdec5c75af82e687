"""One scenario to be run in a child process, what it may use, and how that ended."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from enum import StrEnum
from pathlib import Path

from pydantic import TypeAdapter

from executive.record import RUN_FILES

GIB = 2**30
LOG = "output.log"
"""What a child printed; there only if it did."""


@dataclass(frozen=True)
class Limits:
    """What one case may use: wall time [s], memory beyond what a child starts with [bytes]."""

    wall_s: float = 900.0
    memory_bytes: int = 4 * GIB


@dataclass(frozen=True)
class Case:
    """A scenario file as `longarm run` takes it, and the folder that the run is written into.

    `text`, where given, is the scenario itself, and `file` only what messages call it; `overrides` are texts
    `key=value` as with `--set`. `instead` gives texts that stand for tree files, by absolute path. `key`
    tells the cases of one batch apart. `cut_ticks` are where the run that this one repeats was cut off.
    """

    key: str
    file: Path
    folder: Path
    text: str | None = None
    seed: int | None = None
    tier: str | None = None
    overrides: tuple[str, ...] = ()
    instead: Mapping[str, str] = field(default_factory=dict)
    limits: Limits = field(default_factory=Limits)
    cut_ticks: tuple[int, ...] = ()

    def to_json(self) -> dict[str, object]:
        """Plain data that `from_json` reads back."""
        return asdict(self) | {"file": str(self.file), "folder": str(self.folder)}

    def clear(self) -> None:
        """Remove what an earlier run left in the folder, and nothing else."""
        for name in (*RUN_FILES, LOG):
            (self.folder / name).unlink(missing_ok=True)

    @classmethod
    def from_json(cls, data: object) -> Case:
        """The case that `to_json` wrote."""
        return _CASE.validate_python(data)


class CaseClass(StrEnum):
    """Whose doing the end of a case was."""

    OK = "ok"
    SUT = "sut"
    """The system under test: it crashed, hung, ate memory, or ended in an error."""
    INFRASTRUCTURE = "infrastructure"
    """The machine or its operator: what the case would have come to is not known."""
    REFUSED = "refused"
    """The scenario cannot be run as it is: nothing was started."""


@dataclass(frozen=True)
class Ending:
    """How a case ended. `cause` is one word (crash, hang, memory, error, killed, start, disk, refused)."""

    case: Case
    kind: CaseClass
    cause: str = ""
    detail: str = ""
    wall_s: float = 0.0
    memory_bytes: int = 0
    attempts: int = 1

    def to_json(self) -> dict[str, object]:
        """Plain data that `from_json` reads back."""
        return asdict(self) | {"case": self.case.to_json()}

    @classmethod
    def from_json(cls, data: object) -> Ending:
        """The ending that `to_json` wrote."""
        return _ENDING.validate_python(data)


_CASE, _ENDING = TypeAdapter(Case), TypeAdapter(Ending)
