"""The `faults:` list of a scenario: a kind with its parameters, when it starts, how long it lasts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel

from executive import plugins
from executive.config.source import Place, Source
from executive.config.validate import Problems, guess, listed, parse, shown
from executive.errors import ConfigError
from executive.faults import ONSETS, FaultSpec, Trigger
from executive.units import DURATION, UnitError, quantity, written

RESERVED = ("from", "for", "name")


@dataclass(frozen=True)
class ResolvedFault:
    """A fault to be injected; `duration_s` None: until the end of the run."""

    name: str
    spec: FaultSpec
    parameters: BaseModel
    start: Trigger
    duration_s: float | None

    def entry(self) -> dict[str, Any]:
        """As the file says it, every default written."""
        entry: dict[str, Any] = {
            self.spec.name: self.parameters.model_dump(mode="json", by_alias=True, exclude_none=True),
            "name": self.name,
            "from": self.start.model_dump(mode="json", exclude_none=True),
        }
        return entry if self.duration_s is None else entry | {"for": written(self.duration_s, "s")}


@dataclass(frozen=True)
class Setting:
    """Where the faults are to act: which backend in which tier, along how many way-points."""

    backend: str
    tier: str
    waypoints: int


def fault_entries(source: Source, at: Place, setting: Setting) -> tuple[ResolvedFault, ...]:
    """Every fault of the list at `at` (none if there is no such list); ConfigError with every complaint."""
    entries = source.data.get("faults") if isinstance(source.data, dict) else None
    if not isinstance(entries, list):
        return ()
    problems = Problems()
    found: list[ResolvedFault] = []
    for index, entry in enumerate(entries):
        place = (*at, index)
        if isinstance(entry, dict):
            fault = problems.attempt(lambda place=place, entry=entry: _fault(source, place, entry, setting))  # type: ignore[misc]  # mypy cannot infer bound lambdas
            if fault is not None:
                if fault.name in {other.name for other in found}:
                    message = f'got a second fault named "{fault.name}", expected a name of its own'
                    problems.add(source.at(place).problem(message))
                found.append(fault)
    problems.check()
    return tuple(found)


def _fault(source: Source, place: Place, entry: dict[str, Any], setting: Setting) -> ResolvedFault:
    kinds = [key for key in entry if key not in RESERVED]
    if len(kinds) != 1:
        got = listed(kinds) if kinds else "no kind of fault"
        message = f"got {got}, expected exactly one kind of fault beside {listed(RESERVED)}"
        raise ConfigError([source.at(place).problem(message)])
    kind = kinds[0]
    problems = Problems()
    spec = problems.attempt(lambda: _spec(source, (*place, kind), kind, setting))
    parameters = problems.attempt(lambda: _parameters(source, (*place, kind), spec)) if spec else None
    start = problems.attempt(lambda: _start(source, place, entry, setting))
    duration_s = problems.attempt(lambda: _duration_s(source, place, entry, spec))
    name = problems.attempt(lambda: _name(source, place, entry, kind))
    problems.check()
    assert spec is not None  # noqa: S101
    assert parameters is not None  # noqa: S101  (else a problem was found)
    assert start is not None  # noqa: S101
    return ResolvedFault(name or kind, spec, parameters, start, duration_s)


def _spec(source: Source, place: Place, kind: str, setting: Setting) -> FaultSpec:
    known = sorted(plugins.found(plugins.FAULTS))
    if kind not in known:
        expected = listed(known) if known else "no fault at all, since none is installed"
        message = f'got the unknown fault "{kind}", expected {expected}{guess(kind, known)}'
        raise ConfigError([source.key_at(place).problem(message)])
    spec = plugins.load(plugins.FAULTS, kind, FaultSpec)
    assert isinstance(spec, FaultSpec)  # noqa: S101  (load has checked)
    fits = (("backend", setting.backend, spec.backends), ("tier", setting.tier, spec.tiers))
    for what, got, able in fits:
        if able and got not in able:
            message = f"got {kind} with the {what} {got}, which it cannot act in; expected {listed(able)}"
            raise ConfigError([source.key_at(place).problem(message)])
    return spec


def _parameters(source: Source, place: Place, spec: FaultSpec) -> BaseModel:
    if source.get(place) is None:
        source = source.graft(place, Source({}, {(): source.at(place)}))
    return parse(source, spec.model, place)


def _start(source: Source, place: Place, entry: dict[str, Any], setting: Setting) -> Trigger:
    if "from" not in entry:
        return Trigger(time="0 s")  # type: ignore[arg-type]  # read as from a file
    start = parse(source, Trigger, (*place, "from"))
    if start.when is not None:
        known = listed([onset for onset in ONSETS if onset != "when"])
        message = f"`when` is not judged yet; expected one of {known}"
        raise ConfigError([source.key_at((*place, "from", "when")).problem(message)])
    if start.waypoint is not None and start.waypoint >= setting.waypoints:
        message = f"got way-point {start.waypoint}, expected 0 to {setting.waypoints - 1}"
        raise ConfigError([source.at((*place, "from", "waypoint")).problem(message)])
    strategies = sorted(plugins.found(plugins.STRATEGIES))
    if start.strategy is not None and start.strategy not in strategies:
        message = f'got the unknown strategy "{start.strategy}", expected {listed(strategies)}'
        place = (*place, "from", "strategy")
        raise ConfigError([source.at(place).problem(message + guess(start.strategy, strategies))])
    return start


def _duration_s(source: Source, place: Place, entry: dict[str, Any], spec: FaultSpec | None) -> float | None:
    if "for" not in entry:
        return None
    if spec is not None and spec.lasting:
        message = f"got a duration of {spec.name}, which cannot be taken back; expected no `for`"
        raise ConfigError([source.key_at((*place, "for")).problem(message)])
    try:
        return quantity(entry["for"], DURATION)
    except UnitError as error:
        raise ConfigError([source.at((*place, "for")).problem(str(error))]) from None


def _name(source: Source, place: Place, entry: dict[str, Any], kind: str) -> str:
    name = entry.get("name", kind)
    if isinstance(name, str) and name:
        return name
    raise ConfigError([source.at((*place, "name")).problem(f"got {shown(name)}, expected a name")])
