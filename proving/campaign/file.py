"""Reads a campaign file: its shape, its scenario, and that everything it may draw makes a valid scenario."""

from __future__ import annotations

import copy
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from executive.config.distributions import NAMES, is_distribution
from executive.config.file_kinds import FileKind
from executive.config.find import find, names, shown
from executive.config.source import Mark, Place, Source, read
from executive.config.validate import Problems, listed, parse
from executive.config.validate import shown as shown_data
from executive.core.errors import ConfigError, Problem
from executive.run.resolve import as_scenario
from executive.run.schema import schema
from proving.campaign.cases import Campaign, Drawn, case_number, resolved, with_faults
from proving.campaign.shape import CampaignFile

_OWN_KEYS = ("seed", "tier", "time_limit", "scenario")
"""Keys of the scenario that the campaign sets by itself."""


def find_campaign(reference: Path) -> Path:
    """The file of this path or bare name."""
    if reference.is_file():
        return reference
    return Path(shown(find("campaigns", str(reference), Path(), Mark("FILE", 1, 1))))


def load_campaign(path: Path) -> Campaign:
    """A campaign file, checked; ConfigError with every problem."""
    return checked(read(path, shown(path.absolute())))


def checked(source: Source) -> Campaign:
    """The same from data already read."""
    problems = Problems()
    file = problems.attempt(parse, source, CampaignFile)
    scenario = problems.attempt(_scenario, source)
    problems.found.extend(problem for place in _keys(source) for problem in _of_key(source, place))
    if file is None or scenario is None:
        raise ConfigError(problems.found)
    campaign = Campaign(file, source, scenario)
    for case in _samples(campaign, problems):
        problems.attempt(resolved, campaign, case)
    problems.check()
    return campaign


def _scenario(source: Source) -> Source:
    """The scenario as a source, its mission inline, its distributions not drawn."""
    data = source.data.get("scenario") if isinstance(source.data, dict) else None
    if isinstance(data, dict):
        return as_scenario(source.part(("scenario",)))
    if not isinstance(data, str):
        raise ConfigError([])  # told where the file as a whole is read
    kind = "missions" if data in names("missions") and data not in names("scenarios") else "scenarios"
    path = find(kind, data, source.folder(), source.at(("scenario",)))
    return as_scenario(read(path, shown(path)))


def _keys(source: Source) -> Iterator[Place]:
    """Where the file says which keys of the scenario vary; what is no mapping is told elsewhere."""
    compare = source.data.get("compare") if isinstance(source.data, dict) else None
    settings = [("compare", name) for name in compare] if isinstance(compare, dict) else []
    for part in (("vary",), ("grid",), *settings):
        if part in source.values and isinstance(source.get(part), dict):
            yield from ((*part, key) for key in source.get(part))


def _of_key(source: Source, place: Place) -> Iterator[Problem]:
    """What is wrong with one of them."""
    key, mark = str(place[-1]), source.key_at(place)
    if key in _OWN_KEYS or not all(key.split(".")):
        yield mark.problem(f'got "{key}", expected a key of the scenario other than {listed(_OWN_KEYS)}')
    elif place[0] == "grid" and ("vary", key) in source.values:
        yield mark.problem(f'got "{key}" in vary and in grid, expected it in one of them')
    elif place[0] == "vary" and not is_distribution(source.get(place)):
        got = shown_data(source.get(place))
        yield source.at(place).problem(f"got {got}, expected a distribution: {listed(NAMES)} of something")


def _samples(campaign: Campaign, problems: Problems) -> Iterator[Drawn]:
    """Cases that together hold every setting, every value of the grid, and every fault once."""
    first = [problems.attempt(case_number, campaign, n) for n in range(len(campaign.settings))]
    good = [case for case in first if case is not None]
    yield from good
    for base in good[:1]:
        for key, values in campaign.file.grid.items():
            for index in range(1, len(values)):
                yield _with(base, key, campaign.source.part(("grid", key, index)))
        entries = campaign.file.faults.from_ if campaign.file.faults else ()
        for index in range(len(entries)):
            yield _with(base, "faults", with_faults(campaign, [index]))


def _with(case: Drawn, key: str, value: Source) -> Drawn:
    return Drawn(case.number, case.draw, case.setting, case.seed, {**case.values, key: value})


def campaign_schema() -> dict[str, Any]:
    """JSON Schema of a campaign file, scenarios inside it included."""
    made = CampaignFile.model_json_schema(by_alias=True)
    inline = copy.deepcopy(schema("scenario"))
    made["$defs"] = made.get("$defs", {}) | inline.pop("$defs", {})
    inline.pop("$schema")
    name = {"type": "string", "description": "a scenario or mission file: a path or a bare name"}
    made["properties"]["scenario"] = {"anyOf": [name, inline]}
    return made


KIND = FileKind("campaign", checked, campaign_schema, holds=("scenario", "mission"))
