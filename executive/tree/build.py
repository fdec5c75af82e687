"""A checked `TreeSpec` → py_trees behaviours, with a store of its own and a trace."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial

from py_trees import decorators
from py_trees.behaviour import Behaviour
from py_trees.common import Status

from executive.core.errors import ConfigError
from executive.tree.nodes.control import ControlNode, NodeContext
from executive.tree.nodes.guarded import Guarded
from executive.tree.nodes.leaf import Leaf
from executive.tree.nodes.services import Services
from executive.tree.ports import REQUIRED, FromTree, PortError
from executive.tree.scope import Scope
from executive.tree.spec import NodeSpec, TreeSpec, fits, root_of, under
from executive.tree.store import Binding, Slot, Store
from executive.tree.trace import Trace


@dataclass(frozen=True)
class BuiltTree:
    """A tree ready to be ticked. `paths` gives the outermost behaviour of every node."""

    root: Behaviour
    trace: Trace
    store: Store
    paths: Mapping[str, Behaviour]


def build(
    spec: TreeSpec,
    services: Services,
    inputs: Mapping[str, object] | None = None,
    strategies: Mapping[str, TreeSpec] | None = None,
) -> BuiltTree:
    """Make the behaviours. `inputs` gives the root tree's ports; `strategies` what `recover` chooses from.

    ConfigError when a required input is missing or an unknown one is given.
    """
    builder = _Builder(services, dict(strategies or {}))
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
    """Makes the behaviours of one tree."""

    def __init__(self, services: Services, strategies: Mapping[str, TreeSpec]) -> None:
        self.services, self.strategies = services, strategies
        self.store, self.trace = Store(), Trace()
        self.paths: dict[str, Behaviour] = {}
        self.recovering = False

    def node(self, path: str, spec: NodeSpec, scope: Scope, skipped: Status) -> Behaviour:
        """The behaviour of a node, its guards around it; `skipped` is what it counts as when skipped."""
        made = self.bare(path, spec, scope)
        if spec.guards:
            made = Guarded(made, spec.name, path, self.trace, spec.guards, scope.read, skipped)
        self.paths[path] = made
        return made

    def bare(self, path: str, spec: NodeSpec, scope: Scope) -> Behaviour:
        if spec.tree is not None:
            return self.subtree(path, spec, spec.tree, scope)
        if spec.kind.leaf is not None:
            return self.leaf(path, spec, spec.kind.leaf, scope)
        if spec.kind.control is not None:
            return self.control(path, spec, spec.kind.control, scope)
        raise TypeError(f"the node type {spec.type!r} is neither a leaf nor a control node nor a tree")

    def leaf(self, path: str, spec: NodeSpec, kind: type[Leaf], scope: Scope) -> Behaviour:
        return kind(spec.name, path, self.services, _bindings(spec, scope), self.trace)

    def control(self, path: str, spec: NodeSpec, kind: type[ControlNode], scope: Scope) -> Behaviour:
        children = [self.node(*child, scope, kind.skipped) for child in under(path, spec.children)]
        strategies = partial(self.instances, path, spec, scope)
        context = NodeContext(spec.name, path, self.trace, self.services, scope.typed, strategies)
        made = kind(_bindings(spec, scope)).make(children, context)
        if any(not port.fixed and port.item_of is None for port in spec.kind.ports):
            vars(made)["tick"] = partial(ticked, made, made.tick, path, self.trace)
        return made

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

    def instances(self, path: str, spec: NodeSpec, scope: Scope) -> dict[str, Behaviour]:
        """Every strategy that fits the tree around, under the node at `path`, its ports bound by name."""
        if self.recovering:
            raise ConfigError(
                [spec.mark.problem(f"got {spec.type} inside a strategy, expected no recursion")]
            )
        self.recovering = True
        made = {
            name: self.strategy(f"{path}/{name}", name, tree, scope)
            for name, tree in self.strategies.items()
            if fits(tree, scope.types)
        }
        self.recovering = False
        return made

    def strategy(self, path: str, name: str, tree: TreeSpec, scope: Scope) -> Behaviour:
        inner = Scope(self.store, path, tree.values, around=scope)
        for port in tree.ports:
            known = scope.types.get(port.name)
            if known is not None and known.name == port.type.name:
                inner.bound[port.name] = scope.binding(port.name)
            else:
                inner.preset(port)
        made = self.instance(path, name, tree, inner)
        self.paths[path] = made
        return made


def ticked(
    node: Behaviour, tick: Callable[[], Iterator[Behaviour]], path: str, trace: Trace
) -> Iterator[Behaviour]:
    """A control node's tick; a port of its own without a value ends it with that reason."""
    try:
        yield from tick()
    except PortError as error:
        trace.fail(path, error.outcome)
        node.feedback_message = error.outcome.detail
        node.stop(Status.FAILURE)
        yield node


def _bindings(spec: NodeSpec, scope: Scope) -> dict[str, Binding]:
    """What each port of a leaf or control node is bound to."""
    bindings: dict[str, Binding] = {}
    for port in spec.kind.ports:
        if port.item_of is not None:
            bindings[port.name] = _item(spec, str(spec.ports[port.name]), scope)
        elif port.name in spec.ports:
            bindings[port.name] = scope.of(spec.ports[port.name])
        else:
            bindings[port.name] = scope.default(port)
    return bindings


def _item(spec: NodeSpec, name: str, scope: Scope) -> Slot:
    """The place where a node writes the item that its child sees."""
    place = scope.binding(name)
    if not isinstance(place, Slot):
        raise ConfigError([spec.mark.problem(f"got {{{name}}}, which is passed in as a literal")])
    return place
