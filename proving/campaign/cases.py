"""What each case of a campaign is: a function of the campaign and the case's number alone.

Numbers run over settings first, then over the grid, then over the repetitions, so that more runs only add
cases. All settings of one repetition share a draw (common random numbers), hence seed and values.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
import yaml

from executive.config.distributions import drawn, is_distribution
from executive.config.overrides import dotted
from executive.config.source import Place, Source
from executive.config.validate import Problems, shown
from executive.core.chance import generator
from executive.core.errors import ConfigError
from executive.run import ResolvedScenario
from executive.run.resolve import resolve
from proving.campaign.shape import CampaignFile
from proving.inject import INSTRUMENT as FAULTS
from proving.inject import RESERVED

Values = Mapping[str, Source]
"""What replaces what in the scenario: dotted key → data with the place it comes from."""


@dataclass(frozen=True)
class Campaign:
    """A campaign file that has been read, with its scenario."""

    file: CampaignFile
    source: Source
    scenario: Source

    @property
    def settings(self) -> tuple[str, ...]:
        """Names of what is compared; one without a name where nothing is."""
        return tuple(self.file.compare or {"": {}})

    @property
    def cells(self) -> tuple[dict[str, int], ...]:
        """The combinations of the grid: dotted key → index into its values."""
        keys = list(self.file.grid)
        ranges = [range(len(values)) for values in self.file.grid.values()]
        return tuple(dict(zip(keys, chosen, strict=True)) for chosen in product(*ranges))

    def total(self, runs: int | None = None) -> int:
        """The number of cases for so many runs (as many as the file says)."""
        return (runs or self.file.runs) * len(self.cells) * len(self.settings)


@dataclass(frozen=True)
class Drawn:
    """One case: its number, its setting and seed, and what is put into the scenario."""

    number: int
    draw: int
    setting: str
    seed: int
    values: Values

    @property
    def parameters(self) -> dict[str, str]:
        """What the campaign chose, as text: everything but seed, tier and limits; of faults, the kinds."""
        told = {key: value.data for key, value in self.values.items() if key not in ("tier", "time_limit")}
        return {key: _kinds(data) if key == "faults" else _text(data) for key, data in told.items()}


@dataclass(frozen=True)
class Prepared:
    """A case ready to be run: its scenario with every default written out, the kind of each fault by name."""

    text: str
    kinds: Mapping[str, str]


def _text(data: object) -> str:
    return data if isinstance(data, str) else json.dumps(data, ensure_ascii=False)


def _kinds(entries: list[dict[str, Any]]) -> str:
    kinds = [next((key for key in entry if key not in (*RESERVED, "group")), "group") for entry in entries]
    return ", ".join(kinds)


def case_number(campaign: Campaign, number: int) -> Drawn:
    """The case of this number. ConfigError where a distribution makes no sense."""
    settings = campaign.settings
    draw, setting = number // len(settings), settings[number % len(settings)]
    seed = seed_of(campaign.file.seed, draw)
    problems, cells = Problems(), campaign.cells
    values: dict[str, Source] = {
        **_fixed(campaign),
        **(problems.attempt(_faults, campaign, seed) or {}),
        **_varied(campaign, seed, problems),
        **_cell(campaign, cells[draw % len(cells)]),
    }
    problems.check()
    for key in (campaign.file.compare or {}).get(setting, {}):
        values[key] = campaign.source.part(("compare", setting, key))
    return Drawn(number, draw, setting, seed, values)


def seed_of(campaign_seed: int, draw: int) -> int:
    """The seed of the `draw`-th repetition: from these two numbers alone."""
    state = np.random.SeedSequence([campaign_seed, draw]).generate_state(1, np.uint64)
    return int(state[0] >> np.uint64(33))


def scenario_of(campaign: Campaign, case: Drawn) -> Source:
    """The campaign's scenario with the values of a case in it, each where the campaign file has it."""
    source = campaign.scenario
    start = campaign.source.at(())
    for key, value in {**case.values, "seed": Source(case.seed, {(): start})}.items():
        source = put(source, key, value)
    return source


def put(source: Source, key: str, value: Source) -> Source:
    """The scenario with one value replaced; ConfigError where it has no such place."""
    place = dotted(key)
    try:
        return source.graft(place, value)
    except (TypeError, IndexError):
        message = f'got "{key}", expected a key of the scenario'
        raise ConfigError([value.at(()).problem(message)]) from None


def resolved(campaign: Campaign, case: Drawn) -> ResolvedScenario:
    """The scenario of a case, checked; ConfigError with what is wrong with it."""
    return resolve(scenario_of(campaign, case))


def prepared(campaign: Campaign, case: Drawn) -> Prepared:
    """The scenario of a case as a file of its own.

    One that cannot be resolved is given as it is: its child will refuse it, and say why.
    """
    try:
        scenario = resolved(campaign, case)
    except ConfigError:
        return Prepared(str(yaml.safe_dump(scenario_of(campaign, case).data, sort_keys=False)), {})
    return Prepared(scenario.dump(), {fault.name: fault.spec.name for fault in scenario.of(FAULTS)})


def draw_at(campaign: Campaign, place: Place, seed: int) -> Source:
    """What stands at a place of the campaign file, a distribution replaced by a value of this seed."""
    part = campaign.source.part(place)
    if not is_distribution(part.data):
        return part
    name = ".".join(map(str, place))
    return drawn(part, (), lambda _: generator(seed, f"campaign {name}"))


def _fixed(campaign: Campaign) -> dict[str, Source]:
    """Tier and time limit, where the campaign says them."""
    file, fixed = campaign.file, {}
    if file.tier is not None:
        fixed["tier"] = campaign.source.part(("tier",))
    if file.limits.mission is not None:
        fixed["time_limit"] = campaign.source.part(("limits", "mission"))
    return fixed


def _varied(campaign: Campaign, seed: int, problems: Problems) -> dict[str, Source]:
    drawn = {key: problems.attempt(draw_at, campaign, ("vary", key), seed) for key in campaign.file.vary}
    return {key: value for key, value in drawn.items() if value is not None}


def _cell(campaign: Campaign, chosen: Mapping[str, int]) -> dict[str, Source]:
    return {key: campaign.source.part(("grid", key, index)) for key, index in chosen.items()}


def _faults(campaign: Campaign, seed: int) -> dict[str, Source]:
    """The scenario's own faults and those drawn, in the order of the file."""
    if campaign.file.faults is None:
        return {}
    number = number_of_faults(campaign, seed)
    places = range(len(campaign.file.faults.from_))
    chosen = sorted(generator(seed, "campaign faults").choice(places, number, replace=False).tolist())
    return {"faults": with_faults(campaign, chosen)}


def number_of_faults(campaign: Campaign, seed: int) -> int:
    """How many faults a case of this seed has; ConfigError if the file says what cannot be."""
    place, most = ("faults", "number"), len(campaign.source.get(("faults", "from")))
    if place not in campaign.source.values:
        return 1
    number = draw_at(campaign, place, seed).data
    if type(number) is not int or not 0 <= number <= most:
        message = f"got {shown(number)}, expected a number of faults from 0 to {most}, or a distribution"
        raise ConfigError([campaign.source.at(place).problem(message)])
    return number


def with_faults(campaign: Campaign, chosen: Sequence[int]) -> Source:
    """The scenario's own faults and these of the campaign's, each where its file has it."""
    base, places = campaign.scenario, [("faults", "from", index) for index in chosen]
    own = base.data.get("faults") if isinstance(base.data, dict) else None
    parts = [base.part(("faults", index)) for index in range(len(own) if isinstance(own, list) else 0)]
    parts += [campaign.source.part(place) for place in places]
    grown = Source([None] * len(parts), {(): campaign.source.at(("faults",))})
    for index, part in enumerate(parts):
        grown = grown.graft((index,), part)
    return grown
