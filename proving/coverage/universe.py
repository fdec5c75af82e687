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
from executive.tree.abilities import FAILS, RUNS, SUCCEEDS, Abilities
from executive.tree.spec import NodeSpec, TreeSpec, fits, root_of, under
from proving.coverage import abilities
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
        return self.node(run_path, f"{tree.name}/{node.name}", node, tree, interrupted, SUCCEEDS)

    def node(
        self, path: str, name: str, node: NodeSpec, around: TreeSpec, interrupted: bool, skipped: str
    ) -> Abilities:
        self.universe.places[path] = name
        words = self.universe.words.setdefault(name, [])  # before its children's, as drawings have it
        leaf = node.kind.leaf
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
        interrupted = interrupted or "while" in node.guards
        if node.tree is not None:
            return [self.root(path, node.tree, interrupted)]
        control, count = node.control, len(node.children)
        skipped = SUCCEEDS if control is None else control.skipped.value.lower()

        def cut(index: int) -> bool:
            return control is not None and control.interrupts(index, count)

        paths, names = under(path, node.children), under(name, node.children)
        able = [
            self.node(run_path, own, child, around, interrupted or cut(index), skipped)
            for index, ((run_path, child), (own, _)) in enumerate(zip(paths, names, strict=True))
        ]
        if node.kind.recovers:
            self.recoveries(path, around, interrupted)
        return able

    def recoveries(self, path: str, around: TreeSpec, interrupted: bool) -> None:
        for name, tree in self.strategies.items():
            if fits(tree, around.values):
                self.universe.strategies[name] = None
                self.root(f"{path}/{name}", tree, interrupted)


def _words(node: NodeSpec, able: Abilities, reasons: list[str], interrupted: bool) -> Iterable[str]:
    """How this node's outcomes are called: a leaf's failures by their reasons."""
    guards = [GUARD] if {"while", "failure_if"} & node.guards.keys() else []
    ends = reasons if node.kind.leaf else [FAILS] if FAILS in able else []
    runs = RUNS in able
    return (
        *([SUCCEEDS] if SUCCEEDS in able else []),
        *ends,
        *guards,
        *([RUNS] if runs else []),
        *([HALTED] if runs and interrupted else []),
    )


def _extend(words: list[str], more: Iterable[str]) -> None:
    words.extend(word for word in more if word not in words)
