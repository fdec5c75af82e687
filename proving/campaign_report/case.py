"""One case of a campaign as the report sees it: what was asked, what came of it, was that good."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from executive.core.units import UnitError, parse
from executive.record import FaultStages, RunResult
from proving.campaign.result import CaseNote, CaseResult
from proving.inject.entries import RESERVED

LOST = "lost"
INFRASTRUCTURE = "infrastructure"
BEYOND_M = 0.001
"""Less than this driven beyond the margin is rounding."""
BROKE = frozenset({INFRASTRUCTURE, "refused"})
"""Classes of cases of which it is not known what they would have come to."""
_PASSED = frozenset({"passed", "expected failure"})


@dataclass(frozen=True, eq=False)
class RecordedCase:
    """`found` is None where the case left no result; `journal` is what the campaign noted at its end."""

    index: int
    folder: Path
    found: CaseResult | None
    scenario: Mapping[str, Any]
    journal: Mapping[str, Any]

    @property
    def result(self) -> RunResult:
        """What its run came to; empty where it left none."""
        return self.found.run if self.found is not None else RunResult()

    @cached_property
    def note(self) -> CaseNote:
        """What the campaign says of the case, in its result or else in its journal."""
        if self.found is not None and self.found.case is not None:
            return self.found.case
        told = self.journal
        return CaseNote(
            self.index,
            setting=str(told.get("setting") or ""),
            verdict=told.get("verdict"),
            class_=str(told.get("class") or ""),
            cause=str(told.get("cause") or ""),
            detail=str(told.get("detail") or ""),
        )

    @property
    def setting(self) -> str:
        return self.note.setting

    @property
    def seed(self) -> int | None:
        """The seed; cases of different settings with the same seed met the same conditions."""
        seed = self.result.seed if self.result.seed is not None else self.journal.get("seed")
        return None if seed is None else int(seed)

    @property
    def class_(self) -> str:
        """`infrastructure` or `sut` (the system under test) where something broke, empty otherwise."""
        return "" if self.note.class_ == "ok" else self.note.class_

    @property
    def outcome(self) -> str:
        """One of `result.json`'s outcomes, or `lost` where the case did not come to its own end."""
        return LOST if self.class_ in BROKE else self.result.outcome or LOST

    @property
    def counts(self) -> bool:
        """Whether the case says anything of the system: not if it was the infrastructure, or never tested."""
        lost = self.outcome == LOST and self.class_ != "sut"
        return not lost and self.class_ not in BROKE and self.outcome != "invalid"

    @cached_property
    def passed(self) -> bool:
        """The campaign's verdict; where it gave none: reached, or what was expected, and safe."""
        if self.note.verdict is not None:
            return self.note.verdict in _PASSED
        rows = self.result.expectations
        as_expected = all(row.met for row in rows) if rows else self.outcome == "reached"
        return as_expected and not self.unsafe and self.outcome not in (LOST, "invalid")

    @cached_property
    def unsafe(self) -> tuple[str, ...]:
        """The safety expectations broken, in words; empty where the rover stayed safe or nothing is known."""
        if self.result.safety is not None:
            return tuple(row.text for row in self.result.safety if row.met is False)
        beyond_m = self.result.truth.driven_beyond_off_track_m or 0.0
        return (
            (f"drove {beyond_m * 1000:.0f} mm beyond the off-track margin",) if beyond_m >= BEYOND_M else ()
        )

    @cached_property
    def quiet_s(self) -> float:
        """Mission time during which no fault can have caused anything: until the first took effect [s]."""
        fired = [row.t_on_s for row in self.faults if row.t_on_s is not None]
        return min([self.result.mission_s, *fired])

    @property
    def cross_share(self) -> float | None:
        """Worst true cross-track error in units of the mission's narrowest off-track margin."""
        worst, margin = self.result.truth.max_cross_track_m, self.off_track_m
        return None if worst is None or not margin else worst / margin

    @cached_property
    def off_track_m(self) -> float | None:
        """The narrowest off-track margin of the mission [m]."""
        mission = self.scenario.get("mission")
        if not isinstance(mission, Mapping):
            return None
        stated = [mission.get("segments") or {}, *(mission.get("waypoints") or [])]
        margins = [_value(part.get("off_track")) for part in stated if isinstance(part, Mapping)]
        return min((m for m in margins if m is not None), default=None)

    @property
    def tilt_limit_deg(self) -> float | None:
        """The tilt beyond which the rover is not safe, as the scenario has it [deg]."""
        rig = self.scenario.get("rig") or {}
        limit = _value((rig.get("rover") or {}).get("tilt_limit"))
        return None if limit is None else math.degrees(limit)

    @cached_property
    def faults(self) -> tuple[FaultStages, ...]:
        """Every fault that was asked for, fired or not, with its kind."""
        kinds = dict(_declared(self.scenario.get("faults") or []))
        rows = {fault.name: fault for fault in self.result.faults}
        found = (rows.get(name, FaultStages(name)) for name in dict.fromkeys([*kinds, *rows]))
        return tuple(replace(each, kind=each.kind or kinds.get(each.name, each.name)) for each in found)

    @cached_property
    def kinds(self) -> tuple[str, ...]:
        """The kinds of its faults, each once, in alphabetical order."""
        return tuple(sorted({row.kind for row in self.faults}))


def _declared(entries: Sequence[Mapping[str, Any]]) -> list[tuple[str, str]]:
    """(name, kind) of the faults that a scenario asks for."""
    found = []
    for entry in entries:
        kind = next((str(key) for key in entry if key not in RESERVED), None)
        if kind is not None:
            found.append((str(entry.get("name") or kind), kind))
    return found


def _value(text: object) -> float | None:
    """A quantity as a resolved scenario writes it, in SI; None where there is none."""
    try:
        return None if text is None else parse(str(text))[0]
    except UnitError:
        return None
