"""The folder of a run: made, cleared of an earlier run, and left as it was found when nothing came of it."""

from __future__ import annotations

import traceback
from pathlib import Path

from executive.core.errors import ConfigError, Problem

RUN_FILES = (
    *("scenario.yaml", "record.mcap", "truth.mcap"),
    *("result.json", "report.html", "traceback.txt"),
)


def make_folder(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        message = f"got {folder}: {error.strerror}, expected a folder that can be written to"
        raise ConfigError([Problem("--out", 1, 1, message)]) from None


def write_traceback(folder: Path, defect: BaseException) -> None:
    (folder / "traceback.txt").write_text("".join(traceback.format_exception(defect)))


def unwrite(folder: Path, made: bool) -> None:
    for name in RUN_FILES:
        (folder / name).unlink(missing_ok=True)
    if made:
        folder.rmdir()


def free_folder(parent: Path, name: str) -> Path:
    """`parent/name`, or with the first free number behind it."""
    folder, number = parent / name, 2
    while folder.exists():
        folder, number = parent / f"{name}-{number}", number + 1
    return folder
