"""A scenario or mission file → everything a run needs, every default written out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import yaml
from pydantic import BaseModel

from executive.config.backends import BackendSpec
from executive.config.distributions import drawn
from executive.config.expect import Expect, with_lists
from executive.config.find import find, portable, shown
from executive.config.known import check_among, check_known
from executive.config.localizers import ChosenLocalizer, localizer_from
from executive.config.mission import mission_problems
from executive.config.models import MissionFile, ScenarioFile
from executive.config.overrides import override
from executive.config.rig_overrides import rig_fields, rig_from
from executive.config.source import Place, Source, read
from executive.config.validate import Problems, guess, listed, parse
from executive.core import plugins
from executive.core.chance import generator
from executive.core.errors import ConfigError, Problem
from executive.core.rig import RigCalibration
from executive.inject.entries import (
    ResolvedFault,
    Setting,
    fault_entries,
    ungrouped,
)
from executive.judge.expected import expect_problems
from executive.run.targets import target_problems
from executive.tree.literals import literal
from executive.tree.load import Instead, load_tree
from executive.tree.spec import TreeSpec
from executive.tree.strategies import load_strategies, strategy_trees


@dataclass(frozen=True)
class ResolvedScenario:
    """All of a run's configuration. Equal values make equal runs."""

    file: ScenarioFile
    world: BaseModel
    rig: RigCalibration
    faults: tuple[ResolvedFault, ...]
    tree: TreeSpec
    backend: BackendSpec
    localizer: ChosenLocalizer
    inputs: Mapping[str, object]
    """The mission's `tree_inputs`, in SI, for the tree's ports of these names."""
    instead: Instead = field(default_factory=dict)
    """Texts that stand for tree files in this run."""

    @property
    def name(self) -> str:
        return self.file.scenario

    @property
    def mission(self) -> MissionFile:
        return self.file.mission

    @property
    def seed(self) -> int:
        return self.file.seed

    @property
    def tier(self) -> str:
        return self.file.tier or self.backend.tiers[0]

    @property
    def expect(self) -> Expect:
        return self.file.expect

    @property
    def time_limit_s(self) -> float:
        return self.file.time_limit

    def with_trees(self, instead: Instead) -> ResolvedScenario:
        """The same run if these tree files said something else; ConfigError where that cannot be loaded."""
        tree = load_tree(self.mission.tree, instead=instead)
        strategy_trees(load_strategies(), instead)
        return replace(self, tree=tree, instead=instead)

    def dump(self) -> str:
        """YAML with every default written; resolves to an equal value, bit for bit."""
        data = self.file.model_dump(mode="json", by_alias=True, exclude_none=True)
        data["localizer"] = self.localizer.entry()
        data["world"] = self.world.model_dump(mode="json", by_alias=True, exclude_none=True)
        data["rig"] = rig_fields(self.rig)
        data["faults"] = [fault.entry() for fault in self.faults]
        return yaml.dump(data, Dumper=_Dumper, sort_keys=False, allow_unicode=True, width=110)


class _Dumper(yaml.SafeDumper):
    """Quotes what another YAML reader might take for something else; knows no aliases."""

    def ignore_aliases(self, data: Any) -> bool:
        return True


def resolve_scenario(
    path: Path | str, seed: int | None = None, tier: str | None = None, overrides: Sequence[str] = ()
) -> ResolvedScenario:
    """Read, default and check a scenario (or a mission, which is a scenario with defaults).

    ConfigError with every problem found; PluginError when the backend named cannot be loaded.
    """
    path = Path(path)
    return resolve_source(read(path, shown(path)), seed, tier, overrides)


def resolve_source(
    source: Source, seed: int | None = None, tier: str | None = None, overrides: Sequence[str] = ()
) -> ResolvedScenario:
    """The same from a file already read, or from a part of one."""
    source = as_scenario(source)
    for number, text in enumerate(overrides, 1):
        source = override(source, text, number)
    source = _with_value(source, "seed", seed)
    source = _with_value(source, "tier", tier)
    return resolve(source)


def resolve(source: Source) -> ResolvedScenario:
    """The same from data already read."""
    problems = Problems()
    source = ungrouped(with_lists(source), ("faults",))
    seed = source.data.get("seed", 0) if isinstance(source.data, dict) else 0
    if isinstance(seed, int):  # what else it may be is told where the file is read
        source = problems.attempt(_drawn, source, abs(seed)) or source
    file = problems.attempt(parse, source, ScenarioFile)
    backend_name = _text(source, "backend", str(ScenarioFile.model_fields["backend"].default))
    backend = problems.attempt(_backend, source, backend_name)
    tier = problems.attempt(_tier, source, backend) if backend else None
    localizer = problems.attempt(localizer_from, source, tier)
    world = problems.attempt(_world, source, backend) if backend else None
    rig = problems.attempt(rig_from, source, ("rig",))
    setting = _setting(source, backend_name, tier)
    faults = problems.attempt(fault_entries, source, ("faults",), setting)
    problems.found.extend(expect_problems(source, faults))
    tree_path = problems.attempt(_tree_path, source)
    tree = problems.attempt(load_tree, tree_path) if tree_path else None
    inputs = problems.attempt(_inputs, source, tree) if tree else None
    if tree is not None:
        problems.found.extend(target_problems(source, faults or (), tree))
    if file is not None:
        impossible = list(mission_problems(source, ("mission",), file.mission))
        problems.found.extend(impossible)
        if backend is not None and world is not None and not impossible:
            problems.found.extend(_world_problems(source, backend, world, file.mission))
    problems.check()
    if tree is None or tree_path is None:
        raise ConfigError([source.at(()).problem("got no tree, expected the name of one")])
    assert file is not None  # noqa: S101  (else a problem was found)
    assert backend is not None  # noqa: S101  (else a problem was found)
    assert localizer is not None  # noqa: S101  (else a problem was found)
    assert world is not None  # noqa: S101  (else a problem was found)
    assert rig is not None  # noqa: S101  (else a problem was found)
    mission = file.mission.model_copy(update={"tree": portable("trees", tree_path)})
    return ResolvedScenario(
        file.model_copy(update={"mission": mission, "tier": tier, "world": {}, "rig": {}, "faults": ()}),
        world,
        rig,
        faults or (),
        tree,
        backend,
        localizer,
        inputs or {},
    )


def _drawn(source: Source, seed: int) -> Source:
    """Every distribution in what a scenario may leave to chance, replaced by a value of this seed."""
    for part in ("world", "rig", "faults"):
        source = drawn(source, (part,), lambda place: generator(seed, f"draw {place}"))
    return source


def as_scenario(source: Source) -> Source:
    """The file's data as a scenario with its mission inline."""
    data = source.data
    if isinstance(data, dict) and "mission" in data and "scenario" not in data and "waypoints" in data:
        return _around(source, str(data["mission"]))
    if isinstance(data, dict) and isinstance(data.get("mission"), str):
        place: Place = ("mission",)
        path = find("missions", data["mission"], source.folder(), source.at(place))
        return source.graft(place, read(path, shown(path)))
    return source


def _around(mission: Source, name: str) -> Source:
    start = mission.at(())
    outer = Source({"scenario": name}, {(): start, ("scenario",): start}, folders={(): mission.folder()})
    return outer.graft(("mission",), mission)


def _with_value(source: Source, key: str, value: int | str | None) -> Source:
    return source if value is None else override(source, f"{key}={value}", 1, f"--{key}")


def _text(source: Source, key: str, default: str) -> str:
    value = source.data.get(key, default) if isinstance(source.data, dict) else default
    return value if isinstance(value, str) else default


def _setting(source: Source, backend: str, tier: str | None) -> Setting:
    """What faults must fit, as far as the file says it; what is wrong with that is told elsewhere."""
    mission = source.data.get("mission") if isinstance(source.data, dict) else None
    points = mission.get("waypoints") if isinstance(mission, dict) else None
    return Setting(backend, tier, len(points) if isinstance(points, list) else 0)


def _backend(source: Source, name: str) -> BackendSpec:
    check_known(source.at(("backend",)), "backend", plugins.BACKENDS, name)
    return plugins.load(plugins.BACKENDS, name, BackendSpec)


def _world(source: Source, backend: BackendSpec) -> BaseModel:
    if not isinstance(source.data, dict):
        raise ConfigError([])  # told where the file as a whole is read
    if "world" not in source.data:
        source = source.graft(("world",), Source({}, {(): source.at(())}, folders={(): source.folder()}))
    return parse(source, backend.world_model, ("world",))


def _world_problems(
    source: Source, backend: BackendSpec, world: BaseModel, mission: MissionFile
) -> list[Problem]:
    found = backend.problems(world, mission.route())
    return [source.at(("world", *problem.place)).problem(problem.message) for problem in found]


def _tree_path(source: Source) -> Path | None:
    place: Place = ("mission", "tree")
    mission = source.data.get("mission") if isinstance(source.data, dict) else None
    if not isinstance(mission, dict):
        return None
    name = mission.get("tree", MissionFile.model_fields["tree"].default)
    if not isinstance(name, str) or not name:
        return None
    return find("trees", name, source.folder(("mission",)), source.at(place))


def _inputs(source: Source, tree: TreeSpec) -> dict[str, object]:
    place: Place = ("mission", "tree_inputs")
    given = source.get(place) if place in source.values else {}
    ports = {port.name: port for port in tree.ports}
    problems = Problems()
    values: dict[str, object] = {}
    for name in given if isinstance(given, dict) else ():
        if name not in ports:
            message = (
                f'got the unknown input "{name}" of {tree.name}, expected {listed(list(ports)) or "none"}'
            )
            problems.add(source.key_at((*place, name)).problem(message + guess(name, ports)))
        else:
            kind = ports[name].type
            values[name] = problems.attempt(literal, source, (*place, name), kind)
    problems.check()
    return values


def _tier(source: Source, backend: BackendSpec) -> str | None:
    """The tier that the file names, or else the backend's first; None where what it says is no name."""
    said = source.data.get("tier") if isinstance(source.data, dict) else None
    if said is None:
        return backend.tiers[0]
    if not isinstance(said, str):
        return None  # told where the file as a whole is read
    check_among(source.at(("tier",)), f"a tier of {backend.name}", said, backend.tiers)
    return said
