"""A checked `TreeSpec` → py_trees behaviours, with a store of its own and a trace."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from py_trees import common, composites, decorators
from py_trees.behaviour import Behaviour
from py_trees.common import Status

from executive.core.attributes import read_attribute
from executive.core.errors import ConfigError
from executive.core.types import Outcome
from executive.core.values import SEGMENT, ValueType
from executive.tree.nodes import situation
from executive.tree.nodes.base import (
    REQUIRED,
    Binding,
    Constant,
    Direction,
    FromTree,
    Leaf,
    PortSpec,
    Slot,
    Store,
    Trace,
)
from executive.tree.nodes.decorators import ForEach, Guarded, Timeout
from executive.tree.nodes.kind import Leaves, leaves
from executive.tree.nodes.loop import Loop
from executive.tree.nodes.recover import Recover
from executive.tree.nodes.services import Services
from executive.tree.spec import Literal, NodeSpec, PortValue, TreeSpec, fits, root_of, under


@dataclass(frozen=True)
class Attribute(Slot):
    """A slot's value seen through attributes: `{segment.end}`."""

    kind: ValueType[Any]
    names: tuple[str, ...]

    def read(self) -> Any:
        return read_attribute(self.kind, super().read(), self.names)

    def write(self, value: object) -> None:
        raise TypeError("an attribute of a value cannot be written to")


@dataclass(frozen=True)
class BuiltTree:
    """A tree ready to be ticked. `paths` gives the outermost behaviour of every node."""

    root: Behaviour
    trace: Trace
    store: Store
    paths: Mapping[str, Behaviour]


@dataclass
class Scope:
    """The values of one instance of a tree: what each name is bound to."""

    store: Store
    path: str
    types: Mapping[str, ValueType[Any]]
    bound: dict[str, Binding] = field(default_factory=dict)

    def binding(self, name: str) -> Binding:
        """The place of a value; one that nobody passed in is the instance's own."""
        if name not in self.bound:
            self.bound[name] = self.store.slot(f"{self.path}:{name}")
        return self.bound[name]

    def preset(self, port: PortSpec) -> None:
        """Give a port that nobody passed in its declared default."""
        if isinstance(port.default, FromTree):
            self.bound[port.name] = Constant(None)
        elif port.direction is Direction.IN:
            self.bound[port.name] = Constant(port.default)
        elif port.default not in (None, REQUIRED):
            self.binding(port.name).write(port.default)

    def of(self, value: PortValue) -> Binding:
        if isinstance(value, Literal):
            return Constant(value.value)
        binding = self.binding(value.name)
        return _through(binding, self.types[value.name], value.attributes) if value.attributes else binding

    def default(self, port: PortSpec) -> Binding:
        """The binding of a port that the file does not mention."""
        if isinstance(port.default, FromTree):
            known = self.types.get(port.default.name)
            fits = known is not None and known.name == port.type.name
            return self.binding(port.default.name) if fits else Constant(None)
        return Constant(None if port.default is REQUIRED else port.default)

    def read(self, name: str, attributes: tuple[str, ...]) -> Any:
        return read_attribute(self.types[name], self.binding(name).read(), attributes)


def _through(binding: Binding, kind: ValueType[Any], names: tuple[str, ...]) -> Binding:
    if isinstance(binding, Attribute):
        return Attribute(binding.store, binding.key, binding.kind, binding.names + names)
    if isinstance(binding, Slot):
        return Attribute(binding.store, binding.key, kind, names)
    return Constant(read_attribute(kind, binding.read(), names))


def build(
    spec: TreeSpec,
    services: Services,
    inputs: Mapping[str, object] | None = None,
    strategies: Mapping[str, TreeSpec] | None = None,
    own: Leaves | None = None,
) -> BuiltTree:
    """Make the behaviours. `inputs` gives the root tree's ports; `strategies` what `recover` chooses from.

    ConfigError when a required input is missing or an unknown one is given.
    """
    builder = _Builder(services, dict(strategies or {}), leaves() if own is None else own)
    scope = Scope(builder.store, spec.name, spec.values)
    _set_inputs(spec, scope, dict(inputs or {}))
    path, root = root_of(spec.name, spec)
    behaviour = builder.node(path, root, scope, Status.SUCCESS)
    return BuiltTree(behaviour, builder.trace, builder.store, builder.paths)


def _set_inputs(spec: TreeSpec, scope: Scope, inputs: Mapping[str, object]) -> None:
    known = {port.name: port for port in spec.ports}
    mark = spec.root.mark
    problems = [mark.problem(f"got the unknown input {name!r}") for name in inputs if name not in known]
    for port in spec.ports:
        if port.name in inputs:
            scope.binding(port.name).write(inputs[port.name])
        elif port.default is REQUIRED:
            problems.append(mark.problem(f"got no input {port.name!r} for the tree {spec.name!r}"))
        elif port.default is not None and not isinstance(port.default, FromTree):
            scope.binding(port.name).write(port.default)
    if problems:
        raise ConfigError(problems)


class _Builder:
    """Makes the behaviours of one tree; each kind of node has its method."""

    def __init__(
        self, services: Services, strategies: Mapping[str, TreeSpec], leaves: Mapping[str, type[Leaf]]
    ) -> None:
        self.services, self.strategies, self.leaves = services, strategies, leaves
        self.store, self.trace = Store(), Trace()
        self.paths: dict[str, Behaviour] = {}
        self.recovering = False

    def node(self, path: str, spec: NodeSpec, scope: Scope, skipped: Status) -> Behaviour:
        """The behaviour of a node, its guards around it."""
        made = self.bare(path, spec, scope)
        if spec.guards:
            made = Guarded(made, spec.name, path, self.trace, spec.guards, scope.read, skipped)
        self.paths[path] = made
        return made

    def bare(self, path: str, spec: NodeSpec, scope: Scope) -> Behaviour:
        if spec.tree is not None:
            return self.subtree(path, spec, spec.tree, scope)
        if spec.type in self.leaves:
            return self.leaf(path, spec, scope)
        makers: dict[str, Callable[[str, NodeSpec, Scope], Behaviour]] = {
            "sequence": self.sequence,
            "selector": self.selector,
            "parallel": self.parallel,
            "loop": self.loop,
            "timeout": self.timeout,
            "for_each": self.for_each,
            "recover": self.recover,
        }
        return makers.get(spec.type, self.decorator)(path, spec, scope)

    def leaf(self, path: str, spec: NodeSpec, scope: Scope) -> Behaviour:
        leaf = self.leaves[spec.type]
        bindings = {
            port.name: scope.of(spec.ports[port.name]) if port.name in spec.ports else scope.default(port)
            for port in leaf.ports()
        }
        return leaf(spec.name, path, self.services, bindings, self.trace)

    def subtree(self, path: str, spec: NodeSpec, tree: TreeSpec, scope: Scope) -> Behaviour:
        inner = Scope(self.store, path, tree.values)
        for port in tree.ports:
            if port.name in spec.ports:
                inner.bound[port.name] = scope.of(spec.ports[port.name])
            elif isinstance(port.default, FromTree):
                inner.bound[port.name] = scope.default(port)
            else:
                inner.preset(port)
        return self.instance(path, spec.name, tree, inner)

    def instance(self, path: str, name: str, tree: TreeSpec, scope: Scope) -> Behaviour:
        root_path, root = root_of(path, tree)
        return decorators.PassThrough(name, self.node(root_path, root, scope, Status.SUCCESS))

    def children(self, path: str, spec: NodeSpec, scope: Scope, skipped: Status) -> list[Behaviour]:
        return [
            self.node(child_path, child, scope, skipped) for child_path, child in under(path, spec.children)
        ]

    def child(self, path: str, spec: NodeSpec, scope: Scope) -> Behaviour:
        (child,) = self.children(path, spec, scope, Status.SUCCESS)
        return child

    def sequence(self, path: str, spec: NodeSpec, scope: Scope) -> Behaviour:
        children = self.children(path, spec, scope, Status.SUCCESS)
        return composites.Sequence(spec.name, spec.literal("memory"), children)

    def selector(self, path: str, spec: NodeSpec, scope: Scope) -> Behaviour:
        children = self.children(path, spec, scope, Status.FAILURE)
        return composites.Selector(spec.name, spec.literal("memory"), children)

    def parallel(self, path: str, spec: NodeSpec, scope: Scope) -> Behaviour:
        policies = {"all": common.ParallelPolicy.SuccessOnAll, "one": common.ParallelPolicy.SuccessOnOne}
        policy = policies[spec.literal("policy")]()
        return composites.Parallel(spec.name, policy, self.children(path, spec, scope, Status.SUCCESS))

    def loop(self, path: str, spec: NodeSpec, scope: Scope) -> Behaviour:
        until, do = self.children(path, spec, scope, Status.SUCCESS)
        return Loop(spec.name, until, do)

    def decorator(self, path: str, spec: NodeSpec, scope: Scope) -> Behaviour:
        child = self.child(path, spec, scope)
        match spec.type:
            case "inverter":
                return decorators.Inverter(spec.name, child)
            case "retry":
                return decorators.Retry(spec.name, child, spec.literal("attempts"))
            case "repeat":
                times = spec.literal("times")
                return decorators.Repeat(spec.name, child, -1 if times is None else times)
            case "force_success":
                return decorators.FailureIsSuccess(spec.name, child)
            case "force_failure":
                return decorators.SuccessIsFailure(spec.name, child)
        raise TypeError(f"no node type {spec.type!r}")

    def timeout(self, path: str, spec: NodeSpec, scope: Scope) -> Behaviour:
        after = scope.of(spec.ports["after"])
        return Timeout(self.child(path, spec, scope), spec.name, path, self.trace, self.services.clock, after)

    def for_each(self, path: str, spec: NodeSpec, scope: Scope) -> Behaviour:
        item = scope.binding(spec.item or "")
        if not isinstance(item, Slot):
            raise ConfigError([spec.mark.problem(f"got {{{spec.item}}}, which is passed in as a literal")])
        return ForEach(self.child(path, spec, scope), spec.name, scope.of(spec.ports["in"]), item)

    def recover(self, path: str, spec: NodeSpec, scope: Scope) -> Behaviour:
        """The child, and beside it an instance of every strategy, its ports bound by name."""
        if self.recovering:
            raise ConfigError([spec.mark.problem("got recover inside a strategy, expected no recursion")])
        child = self.child(path, spec, scope)
        self.recovering = True
        made = {
            name: self.strategy(f"{path}/{name}", name, tree, scope)
            for name, tree in self.strategies.items()
            if fits(tree, scope.types)
        }
        self.recovering = False
        attempts = spec.literal("attempts")
        services, segment = self.services, self.segment(scope)

        def choose(failure: Outcome[object], at_hand: frozenset[str]) -> str | None:
            return situation.choose(services, segment.read(), failure, at_hand)

        def conclude(helped: bool, verified: bool) -> None:
            situation.conclude(services, segment.read() if verified else None, helped)

        return Recover(spec.name, path, self.trace, choose, conclude, attempts, child, made)

    @staticmethod
    def segment(scope: Scope) -> Binding:
        """The segment under way, where the tree around has one."""
        known = scope.types.get("segment")
        return scope.binding("segment") if known is SEGMENT else Constant(None)

    def strategy(self, path: str, name: str, tree: TreeSpec, scope: Scope) -> Behaviour:
        inner = Scope(self.store, path, tree.values)
        for port in tree.ports:
            known = scope.types.get(port.name)
            if known is not None and known.name == port.type.name:
                inner.bound[port.name] = scope.binding(port.name)
            else:
                inner.preset(port)
        made = self.instance(path, name, tree, inner)
        self.paths[path] = made
        return made
