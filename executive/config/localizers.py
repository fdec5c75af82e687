"""What finds the rover, as it registers under `longarm.localizers`, and what a scenario says about it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel

from executive.config.models import DEFAULT_LOCALIZER
from executive.config.registered import registered
from executive.config.source import Mark, Place, Source
from executive.config.validate import Strict, listed, parse, shown
from executive.core.clock import Clock
from executive.core.errors import ConfigError
from executive.core.ports import Devices, Localizer
from executive.core.registry import Kind
from executive.core.rig import Rig
from executive.core.types import Point, PoseSource

_PLACE = ("localizer",)


class NoSettings(Strict):
    """The `settings` of a localizer that has none."""


@dataclass(frozen=True)
class LocalizerRequest:
    """All that a localizer is given. `settings` is an instance of the spec's own model, `tier` a tier of the
    backend; `seed` is the scenario's, for a generator by name (executive.core.chance.generator)."""

    devices: Devices
    rig: Any
    clock: Clock
    settings: BaseModel
    seed: int
    tier: str


def no_markers(rig: Rig) -> int:
    """The `expected_markers` of a localizer that uses none."""
    return 0


def nothing_to_load() -> None:
    """The `preload` of a localizer that is all there once it is registered."""


def nothing_to_prepare(tell: Callable[[str], None]) -> None:
    """The `prepare` of a localizer that needs nothing made on this machine."""


def not_known(rig: Any, place: Point) -> float:
    """The `best_sigma_m` of a localizer that cannot say."""
    return 0.0


@dataclass(frozen=True)
class LocalizerSpec:
    """A localizer by name.

    `sources` are the names that its fixes bear as `PoseEstimate.source`, none of them one of the core's own
    (executive.core.types.PoseSource); `tiers` those it can work in (empty: any). `needs` names the devices
    that it uses, `rig` the class of rig that it can work with, `expected_markers` how many markers of one it
    looks for.

    `prepare` makes what is made once on a machine (`longarm prepare`, and before a run), and tells each step
    that takes long; it returns at once where that is done. `preload` does what every process would do anew at
    the first fix, for one that is about to fork many. `best_sigma_m` tells, for a rig and a place, the least
    standard deviation of position [m] that a fix there can have, 0 where that is not known; `check` warns of
    tolerances that are finer.
    """

    name: str
    doc: str
    sources: tuple[str, ...]
    make: Callable[[LocalizerRequest], Localizer]
    settings: type[BaseModel] = NoSettings
    tiers: tuple[str, ...] = ()
    needs: tuple[str, ...] = ("cameras", "head")
    rig: type[Any] = object
    expected_markers: Callable[[Any], int] = no_markers
    prepare: Callable[[Callable[[str], None]], None] = nothing_to_prepare
    preload: Callable[[], None] = nothing_to_load
    best_sigma_m: Callable[[Any, Point], float] = not_known


def _broken(spec: LocalizerSpec) -> Iterator[str]:
    if not spec.doc.strip():
        yield "it does not say what it is"
    if not spec.sources:
        yield "it does not name the source of its fixes"
    for source in spec.sources:
        if source in tuple(PoseSource):
            yield f"its fixes claim the source {source!r}, which is no fix"


LOCALIZER_KIND: Kind[LocalizerSpec] = Kind(
    "localizer", "localizers", "What finds the rover.", LocalizerSpec, check=_broken
)


@dataclass(frozen=True)
class ChosenLocalizer:
    """A localizer with its settings, as a scenario names them."""

    spec: LocalizerSpec
    settings: BaseModel

    def entry(self) -> str | dict[str, Any]:
        """What a scenario says for it: its name alone where all settings are the defaults."""
        given = self.settings.model_dump(mode="json", by_alias=True, exclude_none=True)
        return self.spec.name if self.settings == self.spec.settings() else {self.spec.name: given}

    def made(self, devices: Devices, rig: Rig, clock: Clock, seed: int, tier: str) -> Localizer:
        """A localizer for one run."""
        return self.spec.make(LocalizerRequest(devices, rig, clock, self.settings, seed, tier))


def localizer_from(source: Source, tier: str | None) -> ChosenLocalizer:
    """The scenario's `localizer: NAME` or `localizer: {NAME: {...settings}}`; ConfigError with every problem.

    A `tier` of None is not checked.
    """
    name, at, place = _named(source)
    spec = registered(LOCALIZER_KIND, name, at)
    if spec.tiers and tier is not None and tier not in spec.tiers:
        message = f"got {name} with the tier {tier}, in which it cannot work; expected {listed(spec.tiers)}"
        raise ConfigError([at.problem(message)])
    if place is None or source.get(place) is None:
        return ChosenLocalizer(spec, parse(Source({}, {(): at}), spec.settings))
    return ChosenLocalizer(spec, parse(source, spec.settings, place))


def _named(source: Source) -> tuple[str, Mark, Place | None]:
    """The localizer's name, where it stands, and where its settings stand if there are any."""
    scenario = source.data if isinstance(source.data, dict) else {}
    said = scenario.get("localizer", DEFAULT_LOCALIZER)
    if isinstance(said, str):
        return said, source.at(_PLACE), None
    if isinstance(said, dict) and len(said) == 1:
        place = (*_PLACE, *said)
        return str(*said), source.key_at(place), place
    message = f"got {shown(said)}, expected the name of a localizer, or {{NAME: {{...settings}}}}"
    raise ConfigError([source.at(_PLACE).problem(message)])
