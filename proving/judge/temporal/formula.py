"""The shape of a formula of signal temporal logic. Every part keeps the text that it was read from."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from proving.judge.temporal.atoms import Atom


@dataclass(frozen=True)
class Bounds:
    """How far ahead a temporal operator looks, both ends included [ns]; `last_ns` None: to the end."""

    first_ns: int = 0
    last_ns: int | None = None


@dataclass(frozen=True)
class Not:
    text: str = field(compare=False)
    inner: Formula


@dataclass(frozen=True)
class And:
    text: str = field(compare=False)
    left: Formula
    right: Formula


@dataclass(frozen=True)
class Or:
    text: str = field(compare=False)
    left: Formula
    right: Formula


@dataclass(frozen=True)
class Implies:
    text: str = field(compare=False)
    left: Formula
    right: Formula


@dataclass(frozen=True)
class Always:
    text: str = field(compare=False)
    inner: Formula
    bounds: Bounds = Bounds()


@dataclass(frozen=True)
class Eventually:
    text: str = field(compare=False)
    inner: Formula
    bounds: Bounds = Bounds()


@dataclass(frozen=True)
class Until:
    """`right` comes within the bounds, and `left` holds at every sample before it."""

    text: str = field(compare=False)
    left: Formula
    right: Formula
    bounds: Bounds = Bounds()


Formula = Atom | Not | And | Or | Implies | Always | Eventually | Until


def parts(formula: Formula) -> tuple[Formula, ...]:
    """What a formula is directly made of."""
    match formula:
        case Atom():
            return ()
        case Not() | Always() | Eventually():
            return (formula.inner,)
        case And() | Or() | Implies() | Until():
            return (formula.left, formula.right)


def atoms(formula: Formula) -> Iterator[Atom]:
    """Every comparison and flag in it, from left to right."""
    if isinstance(formula, Atom):
        yield formula
    for part in parts(formula):
        yield from atoms(part)


def names(formula: Formula) -> tuple[str, ...]:
    """The signals that it speaks of, each once, in order."""
    return tuple(dict.fromkeys(name for atom in atoms(formula) for name in atom.names))
