"""The folder of a run: made, cleared of an earlier run, and left as it was found when nothing came of it."""

from __future__ import annotations

import fcntl
import os
import shutil
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from executive.core.errors import ConfigError, Problem
from executive.core.files import write_whole
from executive.record.integrity import SUMS

LOCK = ".running"

RUN_FILES = (
    *("scenario.yaml", "record.mcap", "truth.mcap"),
    *("result.json", "report.html", "traceback.txt", SUMS),
)


def refuse_used(folder: Path) -> None:
    """ConfigError for a folder that holds anything but a plain lock: nobody's run is written over unasked."""
    if folder.is_dir() and any(path.name != LOCK for path in folder.iterdir()):
        message = f"got {folder}, which is not empty, expected a new folder, or --force to write over its run"
        raise ConfigError([Problem("--out", 1, 1, message)])


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """The folder is this process's own meanwhile; ConfigError where another run is being written there.

    The lock goes with the process, however that ends.
    """
    path = folder / LOCK
    with path.open("w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            mine = _is_at(path, lock)
        except OSError:
            mine = False
        if not mine:
            message = f"got {folder}, where another run is being written, expected a folder of its own"
            raise ConfigError([Problem("--out", 1, 1, message)])
        try:
            yield
        finally:
            path.unlink(missing_ok=True)


def _is_at(path: Path, file: IO[str]) -> bool:
    """Whether an open file is still the one at this path: its last owner may have removed it meanwhile."""
    return path.exists() and os.path.samestat(path.stat(), os.fstat(file.fileno()))


def make_folder(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        message = f"got {folder}: {error.strerror}, expected a folder that can be written to"
        raise ConfigError([Problem("--out", 1, 1, message)]) from None


def write_traceback(folder: Path, defect: BaseException) -> None:
    write_whole(folder / "traceback.txt", "".join(traceback.format_exception(defect)))


def unwrite(folder: Path) -> None:
    """Remove all that a run writes."""
    for name in RUN_FILES:
        (folder / name).unlink(missing_ok=True)
    shutil.rmtree(folder / "files", ignore_errors=True)


def free_folder(parent: Path, name: str) -> Path:
    """`parent/name`, or with the first free number behind it."""
    folder, number = parent / name, 2
    while folder.exists():
        folder, number = parent / f"{name}-{number}", number + 1
    return folder
