"""What the records of runs show."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from executive.config.project import read_project
from executive.config.source import read_text
from executive.core.errors import ConfigError, RecordError
from executive.core.registry import Project, current_project, in_project
from executive.core.types import Call, Reason
from executive.record import History, events, leading
from executive.tree.load import load_tree
from executive.tree.strategies import usable_trees
from proving.coverage.items import Item
from proving.coverage.universe import HALTED, Universe
from proving.inject.entries import RESERVED
from proving.inject.onsets import Sightings


@dataclass
class Seen:
    """How often each item was shown, and the first run that did; failures that a leaf does not declare."""

    count: Counter[Item] = field(default_factory=Counter)
    first: dict[Item, str] = field(default_factory=dict)
    undeclared: Counter[Item] = field(default_factory=Counter)
    strangers: Counter[str] = field(default_factory=Counter)
    """Paths that the trees as they are now do not have."""
    runs: list[str] = field(default_factory=list)

    def add(self, run: str, history: History, universe: Universe) -> None:
        """Take in one run; its tree must be part of the universe."""
        self.runs.append(run)
        for item in (*self._of_nodes(history, universe), *_of_the_rest(history)):
            self.count[item] += 1
            self.first.setdefault(item, run)

    def _of_nodes(self, history: History, universe: Universe) -> Iterator[Item]:
        before: dict[str, str] = {}
        for _, change in history.all(events.NodeChange):
            name = universe.places.get(change.path)
            word = _word(change, before.get(change.path, ""), name in universe.leaves)
            before[change.path] = change.status
            if name is None:
                if not _is_strategy(change.path, universe):
                    self.strangers[change.path] += 1
                continue
            for said in word:
                item = Item("node", name, said)
                if said in universe.words[name]:
                    yield item
                elif name in universe.leaves and said != HALTED:
                    self.undeclared[item] += 1


def _word(change: events.NodeChange, before: str, leaf: bool) -> tuple[str, ...]:
    if change.status == "invalid":
        return (HALTED,) if before == "running" else ()
    if change.status != "failure":
        return (change.status,)
    if leaf:
        return (change.reason or "failure",)
    return ("failure", change.reason) if change.reason == Reason.GUARD else ("failure",)


def _is_strategy(path: str, universe: Universe) -> bool:
    """The frame around a strategy's tree is no node of a file; what is in it counts."""
    return path.rsplit("/", 1)[-1] in universe.strategies


def _of_the_rest(history: History) -> Iterator[Item]:
    sightings, kinds = Sightings(), _kinds_of_faults(history)
    for command in history.all(events.Command):
        sightings.hear(command.event)
    for call in history.all(Call):
        sightings.hear(call.event)
    for _, strategy in history.all(events.StrategyEvent):
        sightings.hear(strategy)
        yield Item("strategy", strategy.name, str(strategy.verdict))
    yield from (Item("phase", name, "entered") for kind, name in sightings.entered if kind == "phase")
    for _, fault in history.all(events.FaultEvent):
        if fault.active:
            yield Item("fault", kinds.get(fault.name, fault.name), "fired")
    for _, hypotheses in history.all(events.HypothesesEvent):
        if (led := leading(hypotheses)) is not None:
            yield Item("hypothesis", led, "led")


def scenario_of(history: History) -> dict[str, Any]:
    """The resolved scenario that a record starts with; RecordError where it does not."""
    start = history.last(events.Start)
    data = read_text(start.event.scenario_yaml, "scenario.yaml").data if start else None
    if not isinstance(data, dict):
        raise RecordError("got a record without its scenario, expected one with a start")
    return data


def _kinds_of_faults(history: History) -> dict[str, str]:
    """The kind of each fault by the name it goes by in this run."""
    return {
        str(entry.get("name", kind)): kind
        for entry in scenario_of(history).get("faults", ())
        for kind in entry
        if kind not in RESERVED
    }


def read_runs(folders: list[Path]) -> tuple[Universe, Seen]:
    """The runs in these folders, at any depth, and everything that their trees could have shown.

    RecordError where a folder has no run in it; ConfigError for a tree that is not there any more.
    """
    universe, seen = Universe(), Seen()
    known: set[Path | str] = set()
    for record in _records(folders):
        history = History.of(record)
        try:
            scenario = scenario_of(history)
            tree = str(scenario["mission"]["tree"])
        except (RecordError, ConfigError, KeyError):
            continue  # cut off before it began: it shows nothing
        kept = record.parent / tree
        reference = kept if kept.is_file() else tree  # a tree of one's own lies in the run folder
        if reference not in known:
            known.add(reference)
            with in_project(_project_of(record.parent, scenario)):
                universe.add(load_tree(reference), usable_trees())
        seen.add(str(record.parent), history, universe)
    return universe, seen


def _project_of(folder: Path, scenario: Mapping[str, Any]) -> Project | None:
    """The project that a run kept in its folder; else the one under way."""
    file = folder / str(scenario.get("project", ""))
    return read_project(file) if file.is_file() else current_project()


def _records(folders: list[Path]) -> list[Path]:
    found = []
    for folder in folders:
        inside = sorted(folder.rglob("record.mcap"))
        if not inside:
            raise RecordError(f"{folder}: got no record.mcap, expected a run folder or folders of runs")
        found += inside
    return list(dict.fromkeys(found))
