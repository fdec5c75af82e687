"""One case of a campaign as the report sees it: what was asked, what came of it, was that good."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from executive.core.units import UnitError, parse
from proving.inject.entries import RESERVED

LOST = "lost"
INFRASTRUCTURE = "infrastructure"
BEYOND_M = 0.001
"""Less than this driven beyond the margin is rounding."""
BROKE = frozenset({INFRASTRUCTURE, "refused"})
"""Classes of cases of which it is not known what they would have come to."""
_PASSED = frozenset({"passed", "expected failure"})


@dataclass(frozen=True)
class FaultRow:
    """A fault of a case. Mission times [s], None for never; latencies count from its taking effect."""

    kind: str
    name: str
    fired: bool
    t_on_s: float | None
    t_detected_s: float | None
    t_isolated_s: float | None
    t_recovered_s: float | None
    concluded: str | None
    expected: str | None

    def latency_s(self, until_s: float | None) -> float | None:
        """From taking effect until then [s]; None for never."""
        return None if until_s is None or self.t_on_s is None else max(until_s - self.t_on_s, 0.0)


@dataclass(frozen=True, eq=False)
class Case:
    """`result` is empty where the case left none; `journal` is what the campaign noted at its end."""

    index: int
    folder: Path
    result: Mapping[str, Any]
    scenario: Mapping[str, Any]
    journal: Mapping[str, Any]

    @property
    def about(self) -> Mapping[str, Any]:
        """What the campaign says of the case: seed, setting, verdict, class."""
        return {**self.journal, **(self.result.get("case") or {})}

    @property
    def setting(self) -> str:
        return str(self.about.get("setting") or "")

    @property
    def seed(self) -> int | None:
        """The seed; cases of different settings with the same seed met the same conditions."""
        seed = self.about.get("seed", self.result.get("seed"))
        return None if seed is None else int(seed)

    @property
    def class_(self) -> str:
        """`infrastructure` or `sut` (the system under test) where something broke, empty otherwise."""
        found = str(self.about.get("class") or "")
        return "" if found == "ok" else found

    @property
    def outcome(self) -> str:
        """One of `result.json`'s outcomes, or `lost` where the case did not come to its own end."""
        return LOST if self.class_ in BROKE else str(self.result.get("outcome") or LOST)

    @property
    def counts(self) -> bool:
        """Whether the case says anything of the system: not if it was the infrastructure, or never tested."""
        lost = self.outcome == LOST and self.class_ != "sut"
        return not lost and self.class_ not in BROKE and self.outcome != "invalid"

    @cached_property
    def passed(self) -> bool:
        """The campaign's verdict; where it gave none: reached, or what was expected, and safe."""
        if self.about.get("verdict") is not None:
            return str(self.about["verdict"]) in _PASSED
        rows = self.result.get("expectations") or []
        as_expected = all(row["met"] for row in rows) if rows else self.outcome == "reached"
        return as_expected and not self.unsafe and self.outcome not in (LOST, "invalid")

    @cached_property
    def unsafe(self) -> tuple[str, ...]:
        """The safety expectations broken, in words; empty where the rover stayed safe or nothing is known."""
        rows = self.result.get("safety")
        if rows is not None:
            return tuple(str(row["text"]) for row in rows if row.get("met") is False)
        beyond_m = self.truth("driven_beyond_off_track_m") or 0.0
        return (
            (f"drove {beyond_m * 1000:.0f} mm beyond the off-track margin",) if beyond_m >= BEYOND_M else ()
        )

    def truth(self, key: str) -> float | None:
        """One of the true figures, None where it is not known."""
        value = (self.result.get("truth") or {}).get(key)
        return None if value is None else float(value)

    @cached_property
    def quiet_s(self) -> float:
        """Mission time during which no fault can have caused anything: until the first took effect [s]."""
        fired = [row.t_on_s for row in self.faults if row.t_on_s is not None]
        return min([float(self.result.get("mission_s") or 0.0), *fired])

    @property
    def cross_share(self) -> float | None:
        """Worst true cross-track error in units of the mission's narrowest off-track margin."""
        worst, margin = self.truth("max_cross_track_m"), self.off_track_m
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
    def faults(self) -> tuple[FaultRow, ...]:
        """Every fault that was asked for, fired or not."""
        kinds = dict(_declared(self.scenario.get("faults") or []))
        rows = {str(row["name"]): row for row in self.result.get("faults") or []}
        names = dict.fromkeys([*kinds, *rows])
        return tuple(_row(name, kinds.get(name, name), rows.get(name, {})) for name in names)

    @cached_property
    def kinds(self) -> tuple[str, ...]:
        """The kinds of its faults, each once, in alphabetical order."""
        return tuple(sorted({row.kind for row in self.faults}))


def _row(name: str, kind: str, row: Mapping[str, Any]) -> FaultRow:
    detected = row.get("t_detected_s")
    return FaultRow(
        kind=str(row.get("kind") or kind),
        name=name,
        fired=bool(row.get("fired")),
        t_on_s=row.get("t_on_s"),
        t_detected_s=detected,
        t_isolated_s=row.get("t_isolated_s"),
        t_recovered_s=row.get("t_recovered_s"),
        concluded=row.get("hypothesis") if detected is not None else None,
        expected=row.get("expected") or (row.get("hypothesis") if "expected" not in row else None),
    )


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
