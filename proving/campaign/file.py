"""Reads a campaign file: its shape, its scenario, and that everything it may draw makes a valid scenario."""

from __future__ import annotations

import copy
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from executive.config.find import find, names, shown
from executive.config.source import Mark, Place, Source, read
from executive.config.validate import Problems, parse
from executive.config.validate import shown as shown_data
from executive.distributions import NAMES, is_distribution
from executive.errors import ConfigError
from executive.file_kinds import FileKind
from executive.scenario import as_scenario
from executive.schema import schema
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
    file = problems.attempt(lambda: parse(source, CampaignFile))
    scenario = problems.attempt(lambda: _scenario(source))
    if file is not None:
        for key, place in _keys(file):
            problems.attempt(lambda key=key, place=place: _check_key(source, file, key, place))  # type: ignore[misc]  # mypy cannot infer bound lambdas
    problems.check()
    if file is None or scenario is None:
        raise ConfigError([])  # not reached: what is missing is a problem
    campaign = Campaign(file, source, scenario)
    for case in _samples(campaign, problems):
        problems.attempt(lambda case=case: resolved(campaign, case))  # type: ignore[misc]  # mypy cannot infer bound lambdas
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


def _keys(file: CampaignFile) -> Iterator[tuple[str, Place]]:
    yield from ((key, ("vary", key)) for key in file.vary)
    yield from ((key, ("grid", key)) for key in file.grid)
    for name, values in (file.compare or {}).items():
        yield from ((key, ("compare", name, key)) for key in values)


def _check_key(source: Source, file: CampaignFile, key: str, place: Place) -> None:
    mark = source.key_at(place)
    if key in _OWN_KEYS or not all(key.split(".")):
        raise ConfigError(
            [mark.problem(f'got "{key}", expected a key of the scenario beside its seed and tier')]
        )
    if place[0] == "grid" and key in file.vary:
        raise ConfigError([mark.problem(f'got "{key}" in vary and in grid, expected it in one of them')])
    if place[0] == "vary" and not is_distribution(source.get(place)):
        got = shown_data(source.get(place))
        message = f"got {got}, expected a distribution: {{NAME: ...}} with NAME one of {', '.join(NAMES)}"
        raise ConfigError([source.at(place).problem(message)])


def _samples(campaign: Campaign, problems: Problems) -> Iterator[Drawn]:
    """Cases that together hold every setting, every value of the grid, and every fault once."""
    first = [problems.attempt(lambda n=n: case_number(campaign, n)) for n in range(len(campaign.settings))]  # type: ignore[misc]  # mypy cannot infer bound lambdas
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


KIND = FileKind("campaign", checked, campaign_schema)
