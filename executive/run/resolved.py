"""All of a run's configuration, and as YAML."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any, TypeVar, cast

import yaml
from pydantic import BaseModel

from executive.config.backends import BackendSpec
from executive.config.localizers import ChosenLocalizer
from executive.config.models import MissionFile, ScenarioFile
from executive.config.rig_overrides import rig_fields
from executive.core.errors import ConfigError, Problem
from executive.core.registry import Project, in_project
from executive.core.rig import Rig
from executive.pool.known import DEFAULT_POLICY
from executive.run.instrument import InstrumentSpec
from executive.run.instruments import instruments_there_are
from executive.tree.load import Instead, load_tree
from executive.tree.needs import missing
from executive.tree.spec import TreeSpec
from executive.tree.strategies import load_strategies, strategy_trees

S = TypeVar("S")


@dataclass(frozen=True)
class ResolvedScenario:
    """All of a run's configuration. Equal values make equal runs."""

    file: ScenarioFile
    world: BaseModel
    rig: Rig
    settings: Mapping[str, object]
    """What each instrument has read of its keys, by the instrument's name."""
    tree: TreeSpec
    backend: BackendSpec
    localizer: ChosenLocalizer
    project: Project | None
    """Whose plug-ins it uses."""
    inputs: Mapping[str, object]
    """The mission's `tree_inputs`, in SI, for the tree's ports of these names."""
    instead: Instead = field(default_factory=dict)
    """Texts that stand for tree files in this run."""
    warnings: tuple[Problem, ...] = field(default=(), compare=False)
    """What may go wrong although nothing is."""

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
    def policy(self) -> str:
        """How the pool chooses, by name."""
        return self.file.policy or DEFAULT_POLICY

    @property
    def time_limit_s(self) -> float:
        return self.file.time_limit

    def with_trees(self, instead: Instead) -> ResolvedScenario:
        """The same run if these tree files said something else; ConfigError where that cannot be loaded."""
        with in_project(self.project):
            tree = load_tree(self.mission.tree, instead=instead)
            strategy_trees(load_strategies(), instead)
            found = missing(tree, self.backend)
        if found:
            raise ConfigError(found)
        return replace(self, tree=tree, instead=instead)

    def of(self, spec: InstrumentSpec[S]) -> S:
        """What an instrument has read of its keys; KeyError where it is not registered."""
        return cast("S", self.settings[spec.name])

    def dump(self, kept: Mapping[str, str] = MappingProxyType({})) -> str:
        """YAML with every default written; resolves to an equal value, bit for bit.

        A path that is among `kept` is written as what that gives for it.
        """
        data = self.file.model_dump(mode="json", by_alias=True, exclude_none=True)
        data["localizer"] = self.localizer.entry()
        data["world"] = self.world.model_dump(mode="json", by_alias=True, exclude_none=True)
        data["rig"] = rig_fields(self.rig)
        time_limit = data.pop("time_limit")
        with in_project(self.project):
            instruments = instruments_there_are()
        for spec in instruments:
            data |= spec.dump(self.of(spec))
        data["time_limit"] = time_limit
        data |= {key: _moved(data[key], kept) for key in ("project", "mission", "world") if key in data}
        return yaml.dump(data, Dumper=_Dumper, sort_keys=False, allow_unicode=True, width=110)


def _moved(data: Any, kept: Mapping[str, str]) -> Any:
    """Plain data with every path among `kept` replaced."""
    if isinstance(data, dict):
        return {key: _moved(value, kept) for key, value in data.items()}
    if isinstance(data, list):
        return [_moved(value, kept) for value in data]
    return kept.get(data, data) if isinstance(data, str) else data


class _Dumper(yaml.SafeDumper):
    """Quotes what another YAML reader might take for something else; knows no aliases."""

    def ignore_aliases(self, data: Any) -> bool:
        return True
