"""A scenario or mission file → everything a run needs, every default written out."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from executive.config.backends import BACKEND_KIND, BackendSpec, WorldProblem
from executive.config.distributions import drawn
from executive.config.find import find, portable, shown
from executive.config.localizers import ChosenLocalizer, localizer_from
from executive.config.mission import mission_problems
from executive.config.models import MissionFile, ScenarioFile
from executive.config.overrides import override
from executive.config.project import named_project, with_defaults
from executive.config.registered import registered
from executive.config.rig_overrides import rig_from
from executive.config.source import Place, Source, read
from executive.config.validate import Problems, guess, listed, parse
from executive.config.validate import shown as shown_data
from executive.core.arrival import SIGMAS
from executive.core.chance import generator
from executive.core.errors import ConfigError, Problem
from executive.core.registry import Project, in_project
from executive.core.rig import Rig
from executive.core.types import Point
from executive.pool.known import DEFAULT_POLICY, POLICY_KIND
from executive.run.instrument import InstrumentSpec, Setting
from executive.run.instruments import broken_instruments, instruments_there_are
from executive.run.resolved import ResolvedScenario
from executive.tree.literals import literal
from executive.tree.load import load_tree
from executive.tree.needs import devices_of, missing
from executive.tree.spec import TreeSpec


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
    with in_project(named_project(source)):
        source = as_scenario(source)
        for number, text in enumerate(overrides, 1):
            source = override(source, text, number)
        source = _with_value(source, "seed", seed)
        source = _with_value(source, "tier", tier)
        return resolve(source)


def resolve(source: Source) -> ResolvedScenario:
    """The same from data already read."""
    project = named_project(source)
    with in_project(project):
        return _resolve(with_defaults(source, project), project)


def _resolve(source: Source, project: Project | None) -> ResolvedScenario:
    problems, warnings = Problems(), list[Problem]()
    instruments = instruments_there_are()
    for spec in instruments:
        source = spec.expand(source)
    seed = source.data.get("seed", 0) if isinstance(source.data, dict) else 0
    if isinstance(seed, int):  # what else it may be is message where the file is read
        source = problems.attempt(_drawn, source, abs(seed), instruments) or source
    owned = [key for spec in instruments for key in spec.keys]
    file = problems.attempt(parse, source, ScenarioFile, beside=owned)
    if file is None:  # what looks like an unknown key may be that of an instrument that is broken
        problems.found += [source.at(()).problem(str(each)) for each in broken_instruments()]
    backend_name = _text(source, "backend", str(ScenarioFile.model_fields["backend"].default))
    backend = problems.attempt(_backend, source, backend_name)
    tier = problems.attempt(_tier, source, backend) if backend else None
    localizer = problems.attempt(localizer_from, source, tier)
    problems.attempt(_check_policy, source)
    world = problems.attempt(_world, source, backend) if backend else None
    rig = problems.attempt(rig_from, source, ("rig",), backend.rig) if backend else None
    settings = _settings(source, instruments, _setting(source, backend, tier), problems)
    tree_path = problems.attempt(_tree_path, source)
    tree = problems.attempt(load_tree, tree_path) if tree_path else None
    inputs = problems.attempt(_inputs, source, tree) if tree else None
    for spec in instruments:
        problems.found.extend(spec.check(source.only(spec.keys), settings, tree))
    if localizer is not None and backend is not None:
        problems.found.extend(_unfit(source, localizer, backend))
    if tree is not None and backend is not None:
        problems.found.extend(missing(tree, backend))
    if file is not None:
        impossible = list(mission_problems(source, ("mission",), file.mission))
        problems.found.extend(impossible)
        if backend is not None and world is not None and not impossible:
            of_the_world = _world_problems(source, backend, world, file.mission)
            problems.found.extend(each for each in of_the_world if not each.warning)
            warnings.extend(each for each in of_the_world if each.warning)
        if localizer is not None and rig is not None and not problems.found:
            warnings.extend(_too_fine(source, file.mission, localizer, rig))
    problems.check()
    if tree is None or tree_path is None:
        raise ConfigError([source.at(()).problem("got no tree, expected the name of one")])
    assert file is not None  # noqa: S101  (else a problem was found)
    assert backend is not None  # noqa: S101  (else a problem was found)
    assert localizer is not None  # noqa: S101  (else a problem was found)
    assert world is not None  # noqa: S101  (else a problem was found)
    assert rig is not None  # noqa: S101  (else a problem was found)
    named = str(project.file) if project is not None else None
    mission = file.mission.model_copy(update={"tree": portable("trees", tree_path)})
    return ResolvedScenario(
        file.model_copy(update={"mission": mission, "project": named, "tier": tier, "world": {}, "rig": {}}),
        world,
        rig,
        settings,
        tree,
        backend,
        localizer,
        project,
        inputs or {},
        warnings=tuple(warnings),
    )


def _settings(
    source: Source, instruments: Sequence[InstrumentSpec[Any]], setting: Setting, problems: Problems
) -> dict[str, object]:
    """What each instrument makes of its keys, by name; without those whose keys cannot be read."""
    read = {spec.name: problems.attempt(spec.read, source.only(spec.keys), setting) for spec in instruments}
    return {name: settings for name, settings in read.items() if settings is not None}


def _drawn(source: Source, seed: int, instruments: Sequence[InstrumentSpec[Any]]) -> Source:
    """Every distribution in what a scenario may leave to chance, replaced by a value of this seed."""
    for part in ("world", "rig", *(key for spec in instruments for key in spec.by_chance)):
        source = drawn(source, (part,), lambda place: generator(seed, f"draw {place}"))
    return source


def as_scenario(source: Source) -> Source:
    """The file's data as a scenario with its mission inline; without one that cannot be read."""
    data = source.data
    if isinstance(data, dict) and "mission" in data and "scenario" not in data and "waypoints" in data:
        return _around(source, str(data["mission"]))
    if isinstance(data, dict) and isinstance(data.get("mission"), str):
        place: Place = ("mission",)
        try:
            path = find("missions", data["mission"], source.folder(), source.at(place))
            return source.graft(place, read(path, shown(path)))
        except ConfigError as error:
            return source.without(place, error.problems)
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


def _setting(source: Source, backend: BackendSpec | None, tier: str | None) -> Setting:
    """What instruments must fit, as far as the file says it; what is wrong with that is message elsewhere."""
    mission = source.data.get("mission") if isinstance(source.data, dict) else None
    points = mission.get("waypoints") if isinstance(mission, dict) else None
    return Setting(backend.name if backend else None, tier, len(points) if isinstance(points, list) else 0)


def _unfit(source: Source, localizer: ChosenLocalizer, backend: BackendSpec) -> Iterator[Problem]:
    """What a localizer needs that the backend's robot is without."""
    spec, mark = localizer.spec, source.at(("localizer",))
    lacking = [name for name in spec.needs if name not in devices_of(backend)]
    if lacking:
        message = f"{spec.name} needs {', '.join(lacking)}, which the backend {backend.name} does not have"
        yield mark.problem(message)
    if not issubclass(backend.rig, spec.rig):
        message = f"{spec.name} needs a {spec.rig.__name__}, the backend {backend.name} has a"
        yield mark.problem(f"{message} {backend.rig.__name__}")


def _check_policy(source: Source) -> None:
    registered(POLICY_KIND, _text(source, "policy", DEFAULT_POLICY), source.at(("policy",)))


def _backend(source: Source, name: str) -> BackendSpec:
    return registered(BACKEND_KIND, name, source.at(("backend",)))


def _world(source: Source, backend: BackendSpec) -> BaseModel:
    if not isinstance(source.data, dict):
        raise ConfigError([])  # message where the file as a whole is read
    if "world" not in source.data:
        source = source.graft(("world",), Source({}, {(): source.at(())}, folders={(): source.folder()}))
    return parse(source, backend.world_model, ("world",))


def _world_problems(
    source: Source, backend: BackendSpec, world: BaseModel, mission: MissionFile
) -> list[Problem]:
    found = backend.problems(world, mission.route())
    at = ((source.at(_place_of(problem)), problem) for problem in found)
    return [replace(mark.problem(problem.message), warning=problem.warning) for mark, problem in at]


def _too_fine(
    source: Source, mission: MissionFile, localizer: ChosenLocalizer, rig: Rig
) -> Iterator[Problem]:
    """Tolerances that two standard deviations of the best fix there do not fit into."""
    for index, waypoint in enumerate(mission.waypoints):
        sigma_m = localizer.spec.best_sigma_m(rig, Point(waypoint.x, waypoint.y))
        within_m = mission.zone(index)
        if within_m < SIGMAS * sigma_m:
            best_mm, within_mm = sigma_m * 1e3, within_m * 1e3
            message = (
                f"got a tolerance of {within_mm:.0f} mm where it is found to {best_mm:.0f} mm at best, "
                f"expected two sigma, {SIGMAS * best_mm:.0f} mm, or more: it may end arrival_uncertain"
            )
            yield replace(source.at(("mission", "waypoints", index)).problem(message), warning=True)


def _place_of(problem: WorldProblem) -> Place:
    if problem.waypoint is not None:
        return ("mission", "waypoints", problem.waypoint)
    return ("world", *problem.place)


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
        return None  # message where the file as a whole is read
    if said not in backend.tiers:
        expected = f"a tier of {backend.name}: {listed(backend.tiers)}{guess(said, backend.tiers)}"
        raise ConfigError([source.at(("tier",)).problem(f"got {shown_data(said)}, expected {expected}")])
    return said
