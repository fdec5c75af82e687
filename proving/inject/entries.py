"""The `faults:` list of a scenario: kind and parameters, when it starts, how long it lasts, its profile.

Faults with one `cause` come and go together; a `group` writes that once for several:

    - group: dust_storm
      from: {time: 20 min}
      for: 10 min
      faults: [{led_dim: {marker: 0}}, {image_blur: {sigma: 1.5}}]
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel

from executive.config.registered import registered
from executive.config.source import Place, Source
from executive.config.validate import Problems, listed, parse, shown
from executive.core.errors import ConfigError
from executive.core.units import (
    DURATION,
    UnitError,
    quantity,
    written,
)
from executive.record import live_types
from executive.run import FAULT_KIND, FaultSpec, Setting
from executive.tree.expressions.guards import parse_guard
from executive.tree.expressions.typed import GuardError
from executive.tree.strategies import usable_strategy
from proving.inject import profiles as profiles
from proving.inject.profiles import Profile
from proving.inject.triggers import Trigger

RESERVED = ("from", "for", "name", "profile", "cause")
SHARED = ("from", "for", "profile")


@dataclass(frozen=True)
class ResolvedFault:
    """A fault to be injected; `duration_s` None: until the end of the run; `profile` None: a step."""

    name: str
    spec: FaultSpec
    parameters: BaseModel
    start: Trigger
    duration_s: float | None
    profile: Profile | None = None
    cause: str | None = None

    def entry(self) -> dict[str, Any]:
        """As the file says it, every default written."""
        entry: dict[str, Any] = {
            self.spec.name: self.parameters.model_dump(mode="json", by_alias=True, exclude_none=True),
            "name": self.name,
            "from": self.start.model_dump(mode="json", exclude_none=True),
        }
        if self.duration_s is not None:
            entry["for"] = written(self.duration_s, "s")
        if self.profile is not None:
            entry["profile"] = profiles.entry(self.profile)
        return entry if self.cause is None else entry | {"cause": self.cause}


def fault_entries(source: Source, at: Place, setting: Setting) -> tuple[ResolvedFault, ...]:
    """Every fault of the list at `at` (none if there is no such list); ConfigError with every complaint."""
    problems = Problems()
    found: list[ResolvedFault] = []
    for place, entry in _entries(source, at, problems):
        fault = problems.attempt(_fault, source, place, entry, setting)
        if fault is not None:
            if fault.name in {other.name for other in found}:
                message = f'got a second fault named "{fault.name}", expected a name of its own'
                problems.add(source.at(place).problem(message))
            found.append(fault)
    problems.check()
    return tuple(found)


def ungrouped(source: Source, at: Place) -> Source:
    """The source with every group of the list at `at` written out: its faults in its place, of one cause."""
    entries = source.get(at) if at in source.values else None
    if not isinstance(entries, list) or not any(isinstance(e, dict) and "group" in e for e in entries):
        return source
    flat: list[tuple[Place, dict[str, Place]]] = []
    for index, entry in enumerate(entries):
        place = (*at, index)
        if isinstance(entry, dict) and isinstance(entry.get("faults"), list) and "group" in entry:
            shared = {key: (*place, key) for key in SHARED if key in entry}
            members = range(len(entry["faults"]))
            flat += [((*place, "faults", m), shared | {"cause": (*place, "group")}) for m in members]
        else:
            flat.append((place, {}))
    grown = source.graft(at, Source([None] * len(flat), {(): source.at(at)}))
    for number, (member, shared) in enumerate(flat):
        grown = grown.graft((*at, number), source.part(member))
        for key, place in shared.items():
            if isinstance(grown.get((*at, number)), dict):
                grown = grown.graft((*at, number, key), source.part(place))
    return grown


def _entries(source: Source, at: Place, problems: Problems) -> Iterator[tuple[Place, dict[str, Any]]]:
    entries = source.get(at) if at in source.values else None
    for index, entry in enumerate(entries if isinstance(entries, list) else ()):
        if isinstance(entry, dict) and "group" in entry:
            message = "got a group without a list of faults, expected {group: NAME, faults: [...]}"
            problems.add(source.at((*at, index)).problem(message))
        elif isinstance(entry, dict):
            yield (*at, index), entry


def _fault(source: Source, place: Place, entry: dict[str, Any], setting: Setting) -> ResolvedFault:
    kinds = [key for key in entry if key not in RESERVED]
    if len(kinds) != 1:
        got = listed(kinds) if kinds else "no kind of fault"
        message = f"got {got}, expected exactly one kind of fault beside {listed(RESERVED)}"
        raise ConfigError([source.at(place).problem(message)])
    kind = kinds[0]
    problems = Problems()
    spec = problems.attempt(_spec, source, (*place, kind), kind, setting)
    parameters = problems.attempt(_parameters, source, (*place, kind), spec) if spec else None
    start = problems.attempt(_start, source, place, entry, setting)
    duration_s = problems.attempt(_duration_s, source, place, entry, spec)
    profile = problems.attempt(_profile, source, place, entry, spec)
    name = problems.attempt(_name, source, place, "name", entry, kind)
    cause = problems.attempt(_name, source, place, "cause", entry, None)
    problems.check()
    assert spec is not None  # noqa: S101  (else a problem was found)
    assert parameters is not None  # noqa: S101  (else a problem was found)
    assert start is not None  # noqa: S101  (else a problem was found)
    return ResolvedFault(name or kind, spec, parameters, start, duration_s, profile, cause)


def _spec(source: Source, place: Place, kind: str, setting: Setting) -> FaultSpec:
    spec = registered(FAULT_KIND, kind, source.key_at(place))
    fits = (("backend", setting.backend, spec.backends), ("tier", setting.tier, spec.tiers))
    for what, got, able in fits:
        if able and got is not None and got not in able:
            message = f"got {kind} with the {what} {got}, which it cannot act in; expected {listed(able)}"
            raise ConfigError([source.key_at(place).problem(message)])
    return spec


def _parameters(source: Source, place: Place, spec: FaultSpec) -> BaseModel:
    if source.get(place) is None:
        source = source.graft(place, Source({}, {(): source.at(place)}))
    return parse(source, spec.model, place)


def _start(source: Source, place: Place, entry: dict[str, Any], setting: Setting) -> Trigger:
    if "from" not in entry:
        return Trigger.model_validate({"time": "0 s"})
    start = parse(source, Trigger, (*place, "from"))
    if start.when is not None:
        try:
            parse_guard(start.when, live_types()).check(live_types())
        except GuardError as error:
            mark = source.at((*place, "from", "when"))
            raise ConfigError([mark.problem(error.message, error.offset)]) from None
    if start.waypoint is not None and start.waypoint >= setting.waypoints:
        message = f"got way-point {start.waypoint}, expected 0 to {setting.waypoints - 1}"
        raise ConfigError([source.at((*place, "from", "waypoint")).problem(message)])
    if start.strategy is not None:
        usable_strategy(start.strategy, source.at((*place, "from", "strategy")))
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


def _profile(source: Source, place: Place, entry: dict[str, Any], spec: FaultSpec | None) -> Profile | None:
    if entry.get("profile", profiles.STEP) == profiles.STEP:
        return None
    at = (*place, "profile")
    if isinstance(entry["profile"], str):
        message = f"got {shown(entry['profile'])}, expected step, or a mapping: ramp, intermittent or random"
        raise ConfigError([source.at(at).problem(message)])
    profile = parse(source, Profile, at)
    if spec is not None and profile.ramp is not None and not spec.graded:
        message = f"got a ramp of {spec.name}, which is there or not; expected step, intermittent or random"
        raise ConfigError([source.key_at((*at, "ramp")).problem(message)])
    if spec is not None and profile.ramp is None and spec.lasting:
        message = f"got {spec.name} on and off, which cannot be taken back; expected step"
        raise ConfigError([source.key_at(at).problem(message)])
    return profile


def _name(source: Source, place: Place, key: str, entry: dict[str, Any], default: str | None) -> str | None:
    name = entry.get(key, default)
    if name is None or (isinstance(name, str) and name):
        return name
    raise ConfigError([source.at((*place, key)).problem(f"got {shown(name)}, expected a name")])
