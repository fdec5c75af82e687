"""What a record says about one moment: the chain, the hypotheses, what was tried, told, injected."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, TypeVar

from executive.core.errors import ConfigError, Problem, RecordError
from executive.core.types import Call, PoseEstimate, PoseSource
from executive.core.units import UnitError, parse, split
from executive.record import History
from executive.record.events import (
    Command,
    FaultEvent,
    HypothesesEvent,
    LogEvent,
    NodeChange,
    Start,
    Stop,
    StrategyEvent,
)
from executive.record.history import At
from executive.record.result import strategy_rows
from executive.record.run_result import FaultStages, StrategyRow
from executive.report.explain.chain import Chain, ChainLink, Moment
from executive.report.explain.sentence import POOL, sentence

T = TypeVar("T")
_MOST_COMMANDS = 6
_HEAD = ("scenario", "seed", "sentence", "outcome", "reason", "at_s", "end_s")


@dataclass(frozen=True)
class Explanation:
    """Mission times in s. `hypotheses` are as last weighed at `weighed_s`, likeliest first."""

    scenario: str
    seed: int | None
    sentence: str
    outcome: str | None
    reason: str | None
    at_s: float
    end_s: float
    chain: Chain
    failure: Chain
    pose: PoseEstimate | None
    hypotheses: Mapping[str, float]
    weighed_s: float | None
    time_to_margin_s: float | None
    strategies: tuple[StrategyRow, ...]
    refusals: tuple[At[str], ...]
    calls: tuple[At[Call], ...]
    commands: tuple[At[Command], ...]
    faults: tuple[FaultStages, ...]

    def as_json(self) -> dict[str, object]:
        """Plain data for `--json`."""
        return {
            **{key: getattr(self, key) for key in _HEAD},
            "chain": [_link(link) for link in self.chain],
            "failure": [_link(link) for link in self.failure],
            "pose": None if self.pose is None else _pose(self.pose),
            "hypotheses": dict(self.hypotheses),
            "weighed_s": self.weighed_s,
            "time_to_margin_s": self.time_to_margin_s,
            "strategies": [asdict(row) for row in self.strategies],
            "refusals": [{"t_s": at.time_s, "why": at.event} for at in self.refusals],
            "calls": [
                {"t_s": at.time_s, "reason": at.event.reason.value, "detail": at.event.detail}
                for at in self.calls
            ],
            "commands": [
                {"t_s": at.time_s, "device": c.device, "verb": c.verb, "values": dict(c.values)}
                for at in self.commands
                for c in (at.event,)
            ],
            "faults": [_fault(fault) for fault in self.faults],
        }


def explain(folder: Path, at: str | None = None) -> Explanation:
    """Explain a run at a mission time such as `"12 min"` (a bare number counts as s), by default its end.

    RecordError without a record; ConfigError for a time that is none or lies outside the record.
    """
    if not (folder / "record.mcap").is_file():
        raise RecordError(f"{folder}: got no record.mcap, expected a run folder")
    history = History.of(folder / "record.mcap")
    truth = folder / "truth.mcap"
    world = History.of(truth) if truth.is_file() else History.empty()
    at_s = history.end_s if at is None else _time(at, history.end_s)
    start, stop = history.last(Start), history.last(Stop)
    moment = Moment(history.all(NodeChange), at_s)
    chain = moment.chain()
    strategies = _until(history, StrategyEvent, at_s)
    refused = [At(t, e.message) for t, e in _until(history, LogEvent, at_s) if e.name == POOL]
    weighed = _until(history, HypothesesEvent, at_s)
    poses = [e for _, e in _until(history, PoseEstimate, at_s) if e.source != PoseSource.TREND]
    return Explanation(
        scenario=start.event.scenario if start else folder.name,
        seed=start.event.seed if start else None,
        sentence=sentence(history, at_s),
        outcome=stop.event.outcome if stop else None,
        reason=stop.event.reason if stop else None,
        at_s=at_s,
        end_s=history.end_s,
        chain=chain,
        failure=moment.failure([*_times(strategies), *_times(refused)], chain[0].path if chain else ""),
        pose=poses[-1] if poses else None,
        hypotheses=_ranked(weighed[-1].event.weights) if weighed else {},
        weighed_s=weighed[-1].time_s if weighed else None,
        time_to_margin_s=weighed[-1].event.time_to_margin_s if weighed else None,
        strategies=strategy_rows(History.holding(strategies)),
        refusals=tuple(refused),
        calls=tuple(_until(history, Call, at_s)),
        commands=tuple(_until(history, Command, at_s)[-_MOST_COMMANDS:]),
        faults=tuple(_faults(_until(history, FaultEvent, at_s) + _until(world, FaultEvent, at_s))),
    )


def _until(history: History, kind: type[T], at_s: float) -> list[At[T]]:
    return [at for at in history.all(kind) if at.time_s <= at_s]


def _times(events: Sequence[At[Any]]) -> list[float]:
    return [at.time_s for at in events]


def _time(text: str, end_s: float) -> float:
    """The mission time that the command line gives [s]."""
    try:
        number, unit = split(text)
        value = parse(text)[0] if unit else number
        if unit and parse(text)[1] != parse("1 s")[1]:
            raise UnitError(f"got {text!r}, expected a time such as '12 min'")
    except UnitError as error:
        raise ConfigError([Problem("--at", 1, 1, str(error))]) from None
    if not 0 <= value <= end_s:
        message = f"got {text!r}, expected a time within the record, 0 s to {end_s:g} s"
        raise ConfigError([Problem("--at", 1, 1, message)])
    return value


def _ranked(weights: Mapping[str, float]) -> dict[str, float]:
    return dict(sorted(weights.items(), key=lambda pair: -pair[1]))


def _faults(events: list[At[FaultEvent]]) -> list[FaultStages]:
    """Every fault that took effect: since when, until when, what it should be taken for."""
    found: dict[str, FaultStages] = {}
    for time_s, event in sorted(events, key=lambda at: at.time_s):
        if event.active:
            stages = FaultStages(event.name, fired=True, t_on_s=time_s, expected=event.hypothesis or None)
            found.setdefault(event.name, stages)
        elif event.name in found:
            found[event.name] = replace(found[event.name], t_off_s=time_s)
    return list(found.values())


def _fault(fault: FaultStages) -> dict[str, object]:
    return {key: getattr(fault, key) for key in ("name", "t_on_s", "t_off_s", "expected")}


def _link(link: ChainLink) -> dict[str, object]:
    return {
        "name": link.name,
        "path": link.path,
        "status": link.status,
        "since_s": link.since_s,
        "reason": link.reason or None,
        "detail": link.detail or None,
    }


def _pose(pose: PoseEstimate) -> dict[str, object]:
    return {
        "t_s": pose.time_s,
        "source": pose.source,
        "position_site_m": list(pose.position_site_m),
        "heading_rad": pose.heading_rad,
        "sigma_position_m": pose.sigma_position_m,
    }
