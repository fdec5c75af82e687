"""`result.json` as it is inside: what a run came to, every part typed, to JSON and back."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from functools import cache
from pathlib import Path

from pydantic import TypeAdapter, ValidationError

from executive.core.errors import RecordError
from executive.core.files import write_whole
from executive.record.rows import JudgedRow

SCHEMA = 1
_BEHIND_INVALID = re.compile(r"the run ended (\w+)$")  # as the runner words it


@dataclass(frozen=True)
class Waypoints:
    """How many way-points the route has, and how many of them were declared reached."""

    total: int = 0
    reached: int = 0


@dataclass(frozen=True)
class TrueFigures:
    """What truth says of the whole run. All None without truth; else None where a measure is not defined."""

    final_error_m: float | None = None
    waypoint_errors_m: tuple[float | None, ...] | None = None
    max_cross_track_m: float | None = None
    driven_beyond_off_track_m: float | None = None
    max_tilt_deg: float | None = None
    path_m: float | None = None
    tether_max_n: float | None = None


@dataclass(frozen=True)
class Localisations:
    """Precise localisations: how many, how many of them failed, and how far from truth the others were."""

    count: int = 0
    failed: int = 0
    position_rmse_m: float | None = None
    yaw_rmse_deg: float | None = None
    nees_mean: float | None = None


@dataclass(frozen=True)
class StrategyRow:
    """One strategy chosen, against which hypothesis at which weight; `helped` None: not known yet."""

    name: str
    t_s: float
    hypothesis: str
    weight: float
    attempt: int = 1
    helped: bool | None = None
    t_end_s: float | None = None
    why: str = ""


@dataclass(frozen=True)
class FaultStages:
    """What became of one injected fault; mission times [s], None where a stage never came.

    `hypothesis` is what was concluded, `expected` what should have been; `kind` is known to campaigns only.
    """

    name: str
    cause: str | None = None
    fired: bool = False
    t_armed_s: float | None = None
    t_on_s: float | None = None
    t_off_s: float | None = None
    t_observable_s: float | None = None
    t_detected_s: float | None = None
    t_isolated_s: float | None = None
    hypothesis: str | None = None
    expected: str | None = None
    t_recovered_s: float | None = None
    kind: str = ""

    def to_json(self) -> dict[str, object]:
        """Plain data; a kind that is not known is left out."""
        return {key: value for key, value in asdict(self).items() if key != "kind" or value}

    @property
    def concluded(self) -> str | None:
        """What it was taken for; None where it was not detected."""
        return self.hypothesis if self.t_detected_s is not None else None

    def latency_s(self, until_s: float | None) -> float | None:
        """From taking effect until then [s]; None for never."""
        return None if until_s is None or self.t_on_s is None else max(until_s - self.t_on_s, 0.0)


@dataclass(frozen=True)
class FalseAlarm:
    """When the nominal hypothesis ceased to lead although no fault had taken effect, and what led then."""

    t_s: float
    hypothesis: str


@dataclass(frozen=True)
class RunResult:
    """The content of `result.json`. Without arguments: of a run that left nothing."""

    schema: int = SCHEMA
    scenario: str | None = None
    seed: int | None = None
    tier: str | None = None
    digest: str = ""
    outcome: str = ""
    reason: str | None = None
    mission_s: float = 0.0
    wall_s: float | None = None
    wall: Mapping[str, float | None] = field(default_factory=dict)
    waypoints: Waypoints = Waypoints()
    truth: TrueFigures = TrueFigures()
    localisation: Localisations = Localisations()
    strategies: tuple[StrategyRow, ...] = ()
    faults: tuple[FaultStages, ...] = ()
    false_alarms: tuple[FalseAlarm, ...] = ()
    expectations: tuple[JudgedRow, ...] = ()
    safety: tuple[JudgedRow, ...] | None = None
    """None where nobody judged it."""
    resumed_s: tuple[float, ...] = ()
    """When, by mission time, it was cut off and went on."""

    @property
    def ended_as(self) -> str:
        """The outcome; of a run that proves nothing, the one to which it came all the same."""
        behind = _BEHIND_INVALID.search(self.reason or "") if self.outcome == "invalid" else None
        return behind[1] if behind else self.outcome

    def to_json(self) -> dict[str, object]:
        """Plain data in the order of the fields; NaN and infinities, which JSON cannot say, as None."""
        data = {key: _plain(value) for key, value in asdict(self).items()}
        data["faults"] = [_plain(fault.to_json()) for fault in self.faults]
        if self.safety is None:
            del data["safety"]
        if not self.resumed_s:
            del data["resumed_s"]
        return data

    @classmethod
    def from_json(cls, data: object) -> RunResult:
        """The result that plain data stand for, keys unknown here left out; RecordError if it is none."""
        try:
            return _adapter().validate_python(data)
        except ValidationError as error:
            first = error.errors(include_url=False)[0]
            place = ".".join(str(step) for step in first["loc"]) or "the whole"
            raise RecordError(f"not a result of a run: {place}: {first['msg']}") from None


@cache
def _adapter() -> TypeAdapter[RunResult]:
    return TypeAdapter(RunResult)


def read_result(path: Path) -> RunResult:
    """A `result.json`; RecordError where it cannot be read. OSError where there is none."""
    try:
        return RunResult.from_json(json.loads(path.read_text()))
    except ValueError as error:
        raise RecordError(f"{path}: not JSON: {error}") from None


def write_result(path: Path, result: RunResult) -> None:
    """Write strictly valid JSON, with a newline at the end."""
    write_whole(path, json.dumps(result.to_json(), indent=2, allow_nan=False) + "\n")


def _plain(value: object) -> object:
    if isinstance(value, Mapping):
        return {key: _plain(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(inner) for inner in value]
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    return value
