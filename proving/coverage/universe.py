"""Everything that a run of a tree could show: each node's outcomes, and what is beside the tree.

A node counts once, where its tree file has it, however often that tree is used: `trek_to/loop/arrived`
is covered wherever a `trek_to` stands. Outcomes that the structure rules out are no part of it: a sequence
of questions never runs on, and what nothing can interrupt is never halted.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from executive.core import registry
from executive.core.types import Reason
from executive.isc import hypothesis_names
from executive.run import FAULT_KIND
from executive.tree.spec import NodeSpec, TreeSpec, fits, root_of, under
from proving.coverage import abilities
from proving.coverage.abilities import Abilities
from proving.coverage.items import Item
from proving.inject.triggers import PHASES

HALTED, GUARD = "halted", str(Reason.GUARD)
VERDICTS = ("chosen", "helped", "failed")


@dataclass
class Universe:
    """`words` by node of a tree file, in drawing order; `places` leads from paths of a run to these nodes."""

    words: dict[str, list[str]] = field(default_factory=dict)
    places: dict[str, str] = field(default_factory=dict)
    leaves: set[str] = field(default_factory=set)
    strategies: dict[str, None] = field(default_factory=dict)
    trees: dict[str, TreeSpec] = field(default_factory=dict)

    def add(self, tree: TreeSpec, strategies: Mapping[str, TreeSpec]) -> None:
        """Take in a mission's tree, and the strategies that its `recover` nodes can choose."""
        _Walk(self, strategies).root(tree.name, tree, NOT_INTERRUPTED)

    def items(self) -> tuple[Item, ...]:
        """Everything there is to cover, in a stable order."""
        nodes = [Item("node", name, word) for name, words in self.words.items() for word in words]
        chosen = [Item("strategy", name, word) for name in self.strategies for word in VERDICTS]
        phases = [Item("phase", phase, "entered") for phase in PHASES]
        faults = [Item("fault", name, "fired") for name in registry.every(FAULT_KIND)]
        led = [Item("hypothesis", h, "led") for h in hypothesis_names()]
        return (*nodes, *chosen, *phases, *faults, *led)


NOT_INTERRUPTED = False


class _Walk:
    """One walk over a tree as a run has it, children before their parents' abilities are known."""

    def __init__(self, universe: Universe, strategies: Mapping[str, TreeSpec]) -> None:
        self.universe, self.strategies = universe, strategies

    def root(self, path: str, tree: TreeSpec, interrupted: bool) -> Abilities:
        """The nodes of a tree that stands at `path`."""
        self.universe.trees[tree.name] = tree
        run_path, node = root_of(path, tree)
        return self.node(run_path, f"{tree.name}/{node.name}", node, tree, interrupted, abilities.S)

    def node(
        self, path: str, name: str, node: NodeSpec, around: TreeSpec, interrupted: bool, skipped: str
    ) -> Abilities:
        self.universe.places[path] = name
        words = self.universe.words.setdefault(name, [])  # before its children's, as drawings have it
        leaf = abilities.leaf_class(node)
        if leaf is not None:
            able = abilities.of_leaf(leaf)
            self.universe.leaves.add(name)
        else:
            able = abilities.of_inner(node, self.inside(path, name, node, around, interrupted))
        able = abilities.guarded(node, able, skipped)
        reasons = [str(r) for r in leaf.outcomes if r is not Reason.DONE] if leaf else []
        _extend(words, _words(node, able, reasons, interrupted))
        return able

    def inside(
        self, path: str, name: str, node: NodeSpec, around: TreeSpec, interrupted: bool
    ) -> list[Abilities]:
        """The abilities of the children; a recover's strategies are walked, but do not end for its child."""
        interrupted = interrupted or "while" in node.guards or node.type == "timeout"
        if node.tree is not None:
            return [self.root(path, node.tree, interrupted)]
        skipped = abilities.F if node.type == "selector" else abilities.S
        paths, names = under(path, node.children), under(name, node.children)
        able = [
            self.node(run_path, own, child, around, interrupted or _cuts(node, index), skipped)
            for index, ((run_path, child), (own, _)) in enumerate(zip(paths, names, strict=True))
        ]
        if node.type == "recover":
            self.recoveries(path, around, interrupted)
        return able

    def recoveries(self, path: str, around: TreeSpec, interrupted: bool) -> None:
        for name, tree in self.strategies.items():
            if fits(tree, around.values):
                self.universe.strategies[name] = None
                self.root(f"{path}/{name}", tree, interrupted)


def _cuts(node: NodeSpec, index: int) -> bool:
    """Whether a sibling may end this child of a node while it is under way."""
    if node.type == "parallel":
        return len(node.children) > 1
    return index > 0 and node.type in ("sequence", "selector") and not node.literal("memory")


def _words(node: NodeSpec, able: Abilities, reasons: list[str], interrupted: bool) -> Iterable[str]:
    """How this node's outcomes are called: a leaf's failures by their reasons."""
    guards = [GUARD] if {"while", "failure_if"} & node.guards.keys() else []
    ends = reasons if node.category == "leaf" else [abilities.F] if abilities.F in able else []
    runs = abilities.R in able
    return (
        *([abilities.S] if abilities.S in able else []),
        *ends,
        *guards,
        *([abilities.R] if runs else []),
        *([HALTED] if runs and interrupted else []),
    )


def _extend(words: list[str], more: Iterable[str]) -> None:
    words.extend(word for word in more if word not in words)
