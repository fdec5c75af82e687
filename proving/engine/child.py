"""What happens inside the child of one case: the run, and an exit code that says whose fault its end was."""

from __future__ import annotations

import errno
import faulthandler
import os
import resource
import sys
import traceback
from collections.abc import Iterator
from pathlib import Path

from executive.config.find import shown
from executive.config.source import read, read_text
from executive.core.errors import LongarmError
from executive.run import app
from executive.run.resolve import resolve_source
from proving.engine.case import LOG, Case

DONE, REFUSED, DEFECT, MACHINE, MEMORY = 0, 2, 3, 71, 72
"""The child's exit codes; the last two are out of the way of what a plug-in might exit with."""
_OF_THE_MACHINE = frozenset({errno.ENOSPC, errno.EDQUOT, errno.EIO, errno.EROFS, errno.EMFILE, errno.ENFILE})


def run(case: Case) -> int:
    """Run the case; whatever is printed goes to `output.log` in its folder."""
    try:
        _own_output(case)
        _limit_memory(case.limits.memory_bytes)
        return _run(case)
    except LongarmError as error:
        sys.stderr.write(f"{error}\n")
        return REFUSED
    except BaseException as error:
        traceback.print_exception(error, file=sys.stderr)
        return _blame(error)


def _run(case: Case) -> int:
    name = shown(case.file)
    source = read(case.file, name) if case.text is None else read_text(case.text, name)
    scenario = resolve_source(source, case.seed, case.tier, case.overrides)
    if case.instead:
        scenario = scenario.with_trees({Path(file): text for file, text in case.instead.items()})
    options = app.RunOptions(out=case.folder, bar=False, report=False, cut_ticks=case.cut_ticks)
    finished = app.run_scenario(scenario, options)
    return DONE if finished.defect is None else _blame(finished.defect)


def _own_output(case: Case) -> None:
    case.folder.mkdir(parents=True, exist_ok=True)
    log = os.open(case.folder / LOG, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o644)
    os.dup2(log, 1)
    os.dup2(log, 2)
    os.close(log)
    faulthandler.enable(sys.stderr)


def _limit_memory(bytes_more: int) -> None:
    """Let allocations fail somewhat above the limit, in case memory goes faster than it is watched."""
    with open("/proc/self/statm") as file:
        mapped = int(file.read().split()[0]) * resource.getpagesize()
    limit = mapped + bytes_more + bytes_more // 4
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def _blame(error: BaseException) -> int:
    for cause in _causes(error):
        if isinstance(cause, OSError) and cause.errno in _OF_THE_MACHINE:
            return MACHINE
        if isinstance(cause, MemoryError):
            return MEMORY
    return DEFECT


def _causes(error: BaseException | None) -> Iterator[BaseException]:
    while error is not None:
        yield error
        error = error.__cause__ or error.__context__
