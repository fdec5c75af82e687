"""A tree as boxes to draw: titles, ports as small text, what is inside what. Every format starts from it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from executive.tree.node_type import TREE_SYMBOL
from executive.tree.spec import NodeSpec, TreeSpec, fits, root_of, under

MAX_LINE, MAX_GUARD = 44, 72


@dataclass(frozen=True)
class Tag:
    """A word in a small frame at the foot of a box, painted as `outcome` says; faint where it is None."""

    word: str
    outcome: str | None
    tip: str = ""


@dataclass
class Box:
    """One node to draw. Sizes and places are filled in by the layout [px].

    `category` is control, decorator, recovery, leaf or tree; `alternative` marks a strategy that the pool may
    choose; `frame` is the name of the tree whose nodes this box and those under it are; `outcome` is how the
    node ended, where known; `tags` stand at its foot.
    """

    path: str
    title: str
    symbol: str
    category: str
    lines: tuple[str, ...] = ()
    guards: tuple[str, ...] = ()
    children: list[Box] = field(default_factory=list)
    alternative: bool = False
    frame: str | None = None
    outcome: str | None = None
    tags: tuple[Tag, ...] = ()
    x: float = 0.0
    y: float = 0.0
    width: float = 0.0
    height: float = 0.0
    extent: tuple[float, float] = (0.0, 0.0)

    def walk(self) -> Iterator[Box]:
        """This box and all under it, parents first."""
        yield self
        for child in self.children:
            yield from child.walk()


def boxes(
    tree: TreeSpec,
    strategies: Mapping[str, TreeSpec] | None = None,
    outcomes: Mapping[str, str] | None = None,
) -> Box:
    """The boxes of a tree. `strategies` are what a `recover` may choose; `outcomes` gives a word per path."""
    maker = _Maker(strategies or {}, outcomes or {})
    root = Box(tree.name, tree.name, TREE_SYMBOL, "tree", _doc_lines(tree.doc), frame=tree.name)
    root.outcome = maker.outcomes.get(tree.name)
    root.children = [maker.box(*root_of(tree.name, tree), tree)]
    return root


class _Maker:
    def __init__(self, strategies: Mapping[str, TreeSpec], outcomes: Mapping[str, str]) -> None:
        self.strategies, self.outcomes = strategies, outcomes

    def box(self, path: str, node: NodeSpec, around: TreeSpec) -> Box:
        made = Box(
            path,
            node.name,
            node.kind.symbol,
            "recovery" if node.kind.recovers else node.kind.category,
            _lines(node),
            tuple(_cut(f"{word}: {guard.text}", MAX_GUARD) for word, guard in node.guards.items()),
            outcome=self.outcomes.get(path),
        )
        if node.tree is not None:
            made.frame = node.tree.name
            made.children = [self.box(*root_of(path, node.tree), node.tree)]
        else:
            made.children = [self.box(*child, around) for child in under(path, node.children)]
        if node.kind.recovers:
            made.children += [
                self.strategy(f"{path}/{name}", name, tree, made.symbol)
                for name, tree in self.strategies.items()
                if fits(tree, around.values)
            ]
        return made

    def strategy(self, path: str, name: str, tree: TreeSpec, symbol: str) -> Box:
        made = Box(path, name, symbol, "tree", _doc_lines(tree.doc), alternative=True, frame=tree.name)
        made.outcome = self.outcomes.get(path)
        made.children = [self.box(*root_of(path, tree), tree)]
        return made


def _lines(node: NodeSpec) -> tuple[str, ...]:
    """The type where the name does not say it, and the ports, but for fixed ones left at their default."""
    type_line = (node.type,) if node.name != node.type and node.tree is None else ()
    usual = {port.name: port.default for port in node.kind.ports if port.fixed}
    literals = node.literals
    shown = [
        f"{name}: {value}"
        for name, value in node.ports.items()
        if not (name in usual and name in literals and literals[name] == usual[name])
    ]
    return tuple(_cut(line) for line in (*type_line, *shown))


def _doc_lines(doc: str) -> tuple[str, ...]:
    """The first sentence, in lines of readable length."""
    sentence = " ".join(doc.split()).split(". ")[0].rstrip(".")
    lines: list[str] = []
    for word in sentence.split():
        if lines and len(lines[-1]) + len(word) < MAX_LINE:
            lines[-1] += f" {word}"
        else:
            lines.append(word)
    return tuple(lines[:3])


def _cut(text: str, longest: int = MAX_LINE) -> str:
    return text if len(text) <= longest else text[: longest - 1] + "…"
