"""A campaign's folder: `campaign.json`, `journal.jsonl`, `cases/NNNNN/`; safe against a kill at any time.

A case is worked on in `work/` and renamed into `cases/` when all of it is there: from that moment on it
counts. The journal says the same in one line a case, and is what people and reports read.
"""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import IO, Any

from executive.core.errors import ConfigError, Problem
from proving.campaign.tally import Ended

CAMPAIGN, JOURNAL, CASES, WORK = "campaign.json", "journal.jsonl", "cases", "work"
_IDENTITY = ("campaign", "seed", "scenario", "file")
"""What must be equal for a campaign to be carried on."""


class CampaignFolder:
    """One campaign's folder, open for writing."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._journal: IO[str] | None = None

    def case(self, number: int) -> Path:
        """Where the case is once it has ended."""
        return self.path / CASES / f"{number:05d}"

    def work(self, number: int) -> Path:
        """Where it is before."""
        return self.path / WORK / f"{number:05d}"

    def create(self, about: Mapping[str, Any]) -> None:
        """Begin a campaign in a folder that holds none; ConfigError if it does."""
        if (self.path / CAMPAIGN).exists():
            message = f"got {self.path}, which holds a campaign; expected --resume, or another folder"
            raise ConfigError([Problem("--out", 1, 1, message)])
        try:
            (self.path / CASES).mkdir(parents=True, exist_ok=True)
        except OSError as error:
            message = f"got {self.path}: {error.strerror}, expected a folder that can be written to"
            raise ConfigError([Problem("--out", 1, 1, message)]) from None
        self.describe(about)
        self._open()

    def resume(self, about: Mapping[str, Any]) -> list[Ended]:
        """Carry a campaign on: the cases that have ended. ConfigError if it is another one, or none."""
        kept = read_about(self.path)
        if differing := [key for key in _IDENTITY if kept.get(key) != about[key]]:
            message = (
                f"got a campaign with another {' and '.join(differing)} in {self.path}, expected the same"
            )
            raise ConfigError([Problem("--resume", 1, 1, message)])
        shutil.rmtree(self.path / WORK, ignore_errors=True)
        told = {case.number: case for case in read_journal(self.path)}
        self._open()
        for case in self._untold(told):
            self.note(case.to_json())
            told[case.number] = case
        return list(told.values())

    def describe(self, about: Mapping[str, Any]) -> None:
        """Write `campaign.json`, all of it or nothing."""
        write_whole(self.path / CAMPAIGN, json.dumps(about, indent=2, ensure_ascii=False) + "\n")

    def note(self, line: Mapping[str, Any]) -> None:
        """Add a line to the journal; it is on the disk when this returns."""
        if self._journal is None:
            raise ValueError("got a note for a campaign that has not begun")
        self._journal.write(json.dumps(line, ensure_ascii=False) + "\n")
        self._journal.flush()
        os.fsync(self._journal.fileno())

    def keep(self, case: Ended) -> None:
        """The case has ended, and all its files are in `work/`: from now on it counts."""
        os.rename(self.work(case.number), self.case(case.number))
        self.note(case.to_json())

    def close(self) -> None:
        """Remove what was begun and has not ended."""
        if self._journal is not None:
            self._journal.close()
            self._journal = None
        shutil.rmtree(self.path / WORK, ignore_errors=True)

    def _open(self) -> None:
        path = self.path / JOURNAL
        if path.is_file():
            _mend(path)
        self._journal = path.open("a", encoding="utf-8")

    def _untold(self, told: Mapping[int, Ended]) -> Iterator[Ended]:
        """Cases that were killed between the rename and the journal's line."""
        for folder in sorted((self.path / CASES).iterdir()):
            if int(folder.name) not in told:
                yield Ended.from_json(json.loads((folder / "result.json").read_text())["case"]["journal"])


def read_about(folder: Path) -> dict[str, Any]:
    """`campaign.json`; ConfigError if there is none."""
    try:
        about: dict[str, Any] = json.loads((folder / CAMPAIGN).read_text())
    except (OSError, json.JSONDecodeError):
        message = f"got {folder}, expected the folder of a campaign, with {CAMPAIGN} in it"
        raise ConfigError([Problem(str(folder), 1, 1, message)]) from None
    return about


def read_journal(folder: Path) -> list[Ended]:
    """The ended cases that the journal tells of, in the order in which they ended."""
    path = folder / JOURNAL
    lines = path.read_text(encoding="utf-8").split("\n")[:-1] if path.is_file() else []
    told = [json.loads(line) for line in lines if line]
    return [Ended.from_json(line) for line in told if line["event"] == "ended"]


def write_whole(path: Path, text: str) -> None:
    """Write a file so that there is either the old one or the new one, whatever happens."""
    part = path.with_name(path.name + ".part")
    with part.open("w", encoding="utf-8") as file:
        file.write(text)
        file.flush()
        os.fsync(file.fileno())
    os.replace(part, path)


def _mend(journal: Path) -> None:
    """Cut off a last line that was not written to its end."""
    content = journal.read_bytes()
    whole = content.rfind(b"\n") + 1
    if whole < len(content):
        with journal.open("r+b") as file:
            file.truncate(whole)
