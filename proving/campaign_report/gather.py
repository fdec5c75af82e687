"""Reads a campaign folder: the campaign, its journal, and every case it began."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import yaml

from executive.core.errors import RecordError
from proving.campaign.result import CaseResult, read_case
from proving.campaign_report.case import RecordedCase

_Loader: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)  # ten times faster where libyaml is there


@dataclass(frozen=True, eq=False)
class RecordedCampaign:
    """A campaign as the report sees it. `missing` holds a sentence per thing that is not there."""

    folder: Path
    about: Mapping[str, Any]
    cases: tuple[RecordedCase, ...]
    missing: tuple[str, ...]

    @property
    def name(self) -> str:
        return str(self.about.get("campaign") or self.folder.name)

    @property
    def seed(self) -> int:
        return int(self.about.get("seed") or 0)

    @cached_property
    def counted(self) -> tuple[RecordedCase, ...]:
        """The cases that say something of the system."""
        return tuple(case for case in self.cases if case.counts)

    @cached_property
    def settings(self) -> tuple[str, ...]:
        """The settings compared, in the campaign's order; one empty name where there is only one."""
        declared = self.about.get("settings") or ()
        used = {case.setting for case in self.cases}
        ordered = [str(name) for name in declared if str(name) in used]
        return tuple(ordered + sorted(used - set(ordered))) or ("",)

    def of_setting(self, setting: str) -> tuple[RecordedCase, ...]:
        """The counted cases of one setting."""
        return tuple(case for case in self.counted if case.setting == setting)

    @cached_property
    def kinds(self) -> tuple[str, ...]:
        """Every kind of fault that was asked for, in alphabetical order."""
        return tuple(sorted({kind for case in self.cases for kind in case.kinds}))


def gather(folder: Path) -> RecordedCampaign:
    """Read a campaign folder; RecordError if it is none or its campaign.json cannot be read."""
    path = folder / "campaign.json"
    if not path.is_file():
        raise RecordError(f"{folder}: got no campaign.json, expected a campaign folder")
    missing: list[str] = []
    try:
        about = json.loads(path.read_text())
    except ValueError as error:
        raise RecordError(f"{path}: cannot be read: {error}") from None
    journal = _journal(folder / "journal.jsonl", missing)
    begun = {int(child.name): child for child in folder.glob("cases/[0-9]*") if child.name.isdigit()}
    indices = sorted({*begun, *journal})
    cases = tuple(
        _case(i, begun.get(i, folder / "cases" / f"{i:05d}"), journal.get(i, {}), missing) for i in indices
    )
    if not cases:
        missing.append("cases/: no case was begun")
    return RecordedCampaign(folder, about, cases, tuple(missing))


def _case(index: int, folder: Path, journal: Mapping[str, Any], missing: list[str]) -> RecordedCase:
    return RecordedCase(index, folder, _result(folder, missing), _scenario(folder / "scenario.yaml"), journal)


def _result(folder: Path, missing: list[str]) -> CaseResult | None:
    try:
        return read_case(folder / "result.json")
    except FileNotFoundError:
        return None
    except RecordError:
        missing.append(f"cases/{folder.name}/result.json cannot be read: the case counts as lost")
        return None


def _scenario(path: Path) -> Mapping[str, Any]:
    try:
        found = yaml.load(path.read_text(), _Loader) if path.is_file() else {}  # a safe loader, either way
    except yaml.YAMLError:
        return {}
    return found if isinstance(found, dict) else {}


def _journal(path: Path, missing: list[str]) -> dict[int, dict[str, Any]]:
    """By case that ended, all that was noted of it; a line cut off is left out."""
    if not path.is_file():
        missing.append("journal.jsonl: not there; cases that left no folder are not known")
        return {}
    noted: dict[int, dict[str, Any]] = {}
    for entry in _lines(path):
        index = entry.get("case", entry.get("index"))
        if isinstance(index, int):
            noted.setdefault(index, {}).update(entry)
    return {index: entry for index, entry in noted.items() if entry.get("event") == "ended"}


def _lines(path: Path) -> Iterator[dict[str, Any]]:
    for line in path.read_text().splitlines():
        try:
            entry = json.loads(line)
        except ValueError:
            continue
        if isinstance(entry, dict):
            yield entry
