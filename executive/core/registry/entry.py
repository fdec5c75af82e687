"""One thing registered: loaded when it is first used, and named with its source when that fails."""

from __future__ import annotations

import traceback
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from executive.core.errors import Breach, PluginError
from executive.core.registry.kind import Kind


@dataclass(frozen=True, order=True)
class Broken:
    """What cannot be used: an entry of a kind, or with an empty name a whole plug-in module."""

    kind: str
    name: str
    source: str
    reason: str

    def __str__(self) -> str:
        subject = f"{self.kind} {self.name}: " if self.name else ""
        return f"{subject}{self.reason} ({self.source})"


class Entry:
    """A name of a kind and where it comes from. `load` imports it, and may raise anything.

    `source` names the very line that registers it; `origin` gives the package or file that holds the line.
    """

    def __init__(
        self, kind: str, name: str, source: str, load: Callable[[], object], origin: Callable[[], str]
    ) -> None:
        self.kind, self.name, self.source, self.origin = kind, name, source, origin
        self.load = load
        self._kept: tuple[object, Broken | None] | None = None

    def use(self, kind: Kind[Any]) -> object:
        """The thing itself, checked once. PluginError when it cannot be used."""
        thing, broken = self.loaded(kind)
        if broken is not None:
            raise PluginError(str(broken))
        return thing

    def loaded(self, kind: Kind[Any]) -> tuple[object, Broken | None]:
        """The thing, and what is wrong with it; the same answer each time."""
        if self._kept is None:
            self._kept = self._try(kind)
        return self._kept

    def _try(self, kind: Kind[Any]) -> tuple[object, Broken | None]:
        try:
            thing = self.load()
            faults = kind.faults_of(self.name, thing)
        except Breach as breach:  # the plug-in has checked itself on import
            return None, Broken(kind.name, self.name, self.source, "; ".join(breach.broken))
        except Exception as error:  # a plug-in's import may raise anything
            return None, Broken(kind.name, self.name, self.source, why(error))
        return thing, Broken(kind.name, self.name, self.source, "; ".join(faults)) if faults else None


def why(error: BaseException) -> str:
    """An import that failed in a line: what was raised, and the line of the plug-in that raised it."""
    if isinstance(error, SyntaxError):
        return f"SyntaxError: {error.msg} ({Path(str(error.filename)).name}:{error.lineno})"
    words = " ".join(str(error).split())
    frames = [f for f in traceback.extract_tb(error.__traceback__) if not _ours(f.filename)]
    place = f" ({Path(frames[-1].filename).name}:{frames[-1].lineno})" if frames else ""
    return f"{type(error).__name__}: {words}{place}"


def _ours(file: str) -> bool:
    return file.startswith("<frozen") or Path(file).parent == Path(__file__).parent or "importlib" in file
