"""Runs scenarios one child process each, some at a time; kills what takes too long."""

from __future__ import annotations

import json
import multiprocessing
import os
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from multiprocessing.connection import Connection, wait
from multiprocessing.context import ForkProcess
from pathlib import Path
from typing import Any

from executive import plugins
from executive.app import RunOptions, run
from executive.clock import Stopwatch
from executive.errors import LongarmError
from executive.tree.load import Instead

WALL_S = 300.0


@dataclass(frozen=True)
class Case:
    """A scenario file as `longarm run` takes it, and the folder that the run is written into.

    `instead` gives texts for tree files, by absolute path. `key` tells the cases of one batch apart.
    """

    key: str
    file: Path
    folder: Path
    seed: int | None = None
    tier: str | None = None
    overrides: tuple[str, ...] = ()
    instead: Instead = field(default_factory=dict)
    wall_s: float = WALL_S


@dataclass(frozen=True)
class Ended:
    """How a case ended: its result where there is one, else why not (hang, crash, refused)."""

    case: Case
    result: dict[str, Any] | None = None
    cause: str = ""
    detail: str = ""


@dataclass
class _Child:
    case: Case
    process: ForkProcess
    link: Connection
    watch: Stopwatch

    @property
    def left_s(self) -> float:
        return self.case.wall_s - self.watch.elapsed_s()


def run_cases(cases: Iterable[Case], slots: int) -> Iterator[Ended]:
    """The end of each case, in the order in which they end.

    A case is taken from `cases` when a slot is free, and asked for again after each end, so that who gives
    them may wait for a result first. Closing the iterator kills what is under way.
    """
    _preload()
    waiting, alive = iter(cases), list[_Child]()
    try:
        while True:
            while len(alive) < max(1, slots) and (case := next(waiting, None)) is not None:
                alive.append(_begin(case))
            if not alive:
                return
            wait([child.link for child in alive], timeout=max(0.0, min(child.left_s for child in alive)))
            for child in list(alive):
                if (ended := _end_of(child)) is not None:
                    alive.remove(child)
                    yield ended
    finally:
        for child in alive:
            _kill(child)


def _preload() -> None:
    """Import once what every child would else import for itself."""
    for name in plugins.found(plugins.LOCALIZERS):
        plugins.load(plugins.LOCALIZERS, name)


def _begin(case: Case) -> _Child:
    fork = multiprocessing.get_context("fork")
    ours, theirs = fork.Pipe(duplex=False)
    process = fork.Process(target=_work, args=(case, theirs), daemon=True)
    process.start()
    theirs.close()
    return _Child(case, process, ours, Stopwatch())


def _work(case: Case, link: Connection) -> None:
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    os.dup2(nowhere, 2)
    options = RunOptions(case.seed, case.folder, case.tier, case.overrides, False, False, case.instead)
    try:
        run(case.file, options)
        link.send(("", ""))
    except LongarmError as error:
        link.send(("refused", str(error)))
    except Exception as error:
        link.send(("crash", f"{type(error).__name__}: {error}"))


def _end_of(child: _Child) -> Ended | None:
    if child.link.poll():
        try:
            cause, detail = child.link.recv()
        except EOFError:
            child.process.join()
            cause, detail = "crash", f"the process ended with {child.process.exitcode}"
    elif child.left_s <= 0.0:
        cause, detail = "hang", f"not ended after {child.case.wall_s:g} s"
    else:
        return None
    _kill(child)
    kept = child.case.folder / "result.json"
    whole = not cause and kept.is_file()
    return Ended(child.case, json.loads(kept.read_text()) if whole else None, cause, detail)


def _kill(child: _Child) -> None:
    child.process.kill()
    child.process.join()
    child.link.close()
