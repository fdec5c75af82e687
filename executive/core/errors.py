"""What can go wrong that a user can mend, and the one error that marks a defect."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


class LongarmError(Exception):
    """Base of everything a user can fix. Anything else is a defect and keeps its traceback."""


@dataclass(frozen=True, order=True)
class Problem:
    """One located complaint about an input file; `line` and `column` count from 1.

    A warning is no error: the file can be used, and `check` says what may come of it.
    """

    file: str
    line: int
    column: int
    message: str
    warning: bool = False

    def __str__(self) -> str:
        kind = "warning: " if self.warning else ""
        return f"{self.file}:{self.line}:{self.column}: {kind}{self.message}"


class ConfigError(LongarmError):
    """Bad input: carries every problem found, not only the first."""

    def __init__(self, problems: Sequence[Problem]) -> None:
        self.problems = tuple(sorted(set(problems)))
        super().__init__("\n".join(str(p) for p in self.problems))


class PluginError(LongarmError):
    """A plug-in could not be loaded or does not keep its contract; names it and its source."""


class Breach(AssertionError):
    """A plug-in breaks promises of its kind: all of them, each a sentence. The checkers raise it."""

    def __init__(self, subject: str, broken: Sequence[str]) -> None:
        self.subject, self.broken = subject, tuple(broken)
        super().__init__(f"{subject}: {'; '.join(broken)}")


class RecordError(LongarmError):
    """A run folder lacks what was asked of it, or its record cannot be read."""


class DamagedError(RecordError):
    """A record is not what was written; the message says where."""


class StrategyRaised(Exception):
    """A strategy's own code raised: a defect of the plug-in, named."""

    def __init__(self, name: str, cause: BaseException) -> None:
        self.name = name
        super().__init__(f"needs of {name}: {type(cause).__name__}: {cause}")


class NodeRaised(Exception):
    """A leaf raised: a defect, contained. `path` names the node from the root."""

    def __init__(self, path: str, cause: BaseException) -> None:
        self.path = path
        super().__init__(f"{path}: {type(cause).__name__}: {cause}")
