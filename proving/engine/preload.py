"""What is imported before children are forked: all plug-ins at once, what takes long when a case names it."""

from __future__ import annotations

import re
from collections.abc import Iterator

from executive.core import registry
from executive.tree.strategies import usable_trees
from proving.engine.case import Case


class Preloads:
    """The backends and localizers not yet loaded. A campaign on one robot never loads what another needs."""

    def __init__(self) -> None:
        """Import every plug-in; what cannot be loaded is told by the case that asks for it."""
        self._waiting = {
            (kind.name, name): entry.preload
            for kind in registry.kinds()
            for name, entry in registry.every(kind).items()
            if hasattr(entry, "preload")
        }
        usable_trees()

    def load_for(self, case: Case) -> bool:
        """Load what the case will need; whether anything was loaded."""
        needed = list(self._needed(case)) if self._waiting else []
        for key in needed:
            self._waiting.pop(key)()
        return bool(needed)

    def _needed(self, case: Case) -> Iterator[tuple[str, str]]:
        """By what stands after the kind's key in its file, which is resolved in the child alone.

        Where they name none of a kind, the default may be any. What is missed here, the child loads itself.
        """
        text = case.text
        if text is None:
            try:
                text = case.file.read_text(errors="replace")
            except OSError:
                return  # the child says so
        told = "\n".join((text, *case.overrides))
        for kind, name in self._waiting:
            named = re.findall(rf"\b{kind}[\"']?\s*[:=]\W*(\w+)", told)
            if name in named or not named:
                yield kind, name
