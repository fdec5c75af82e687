"""Small safe expressions over the values of a tree: `abs({pose.cross_track}) < {segment.off_track}`.

Arithmetic, comparisons (also chained), and/or/not, abs/min/max, numbers with or without unit, quoted text,
true/false, and references in braces. Dimensions are checked when the tree is loaded. What cannot be decided
at run time (a value unset or not a number, a division by zero, an error in a value's own attribute) is
neither true nor false: `Guard.decide` raises, and `Guard.holds` returns None.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from executive.core.values import ValueType
from executive.tree.expressions import typed as make
from executive.tree.expressions.grammar import Terms
from executive.tree.expressions.typed import (
    Expression,
    GuardError,
    Read,
    UnknownValueError,
    kind_text,
)


class UndecidedError(Exception):
    """A guard is neither true nor false now; the message says why."""


@dataclass(frozen=True)
class Guard:
    """A parsed expression; `text` is as the file has it."""

    text: str
    body: Expression = field(compare=False)

    def decide(self, read: Read) -> bool:
        """True or False; UndecidedError, saying why, where it is neither."""
        try:
            return bool(self.body.evaluate(read))
        except UnknownValueError as unknown:
            raise UndecidedError(str(unknown)) from None
        except ZeroDivisionError:
            raise UndecidedError("division by zero") from None
        except (
            Exception
        ) as error:  # a value's attributes may be anybody's code: no guard lets a node go on by it
            raise UndecidedError(f"{type(error).__name__}: {error}") from error

    def holds(self, read: Read) -> bool | None:
        """True, False, or None where it cannot be decided."""
        try:
            return self.decide(read)
        except UndecidedError:
            return None

    def check(self, types: Mapping[str, ValueType[Any]]) -> None:
        """GuardError unless every name, attribute and dimension fits and the whole is true or false."""
        kind = self.body.kind(types)
        if kind != "flag":
            raise GuardError(self.body.offset, f"got {kind_text(kind)}, expected something true or false")
        if not self.body.references:
            try:
                self.decide(_nothing)
            except UndecidedError as why:
                raise GuardError(self.body.offset, f"this can never be decided: {why}") from None


def _nothing(name: str, attributes: tuple[str, ...]) -> None:
    """Reads no value."""


def parse_guard(text: str, names: Iterable[str] = ()) -> Guard:
    """GuardError when the text is not such an expression. `names` may stand without braces."""
    parser = _Parser(text, names)
    body = parser.disjunction()
    parser.expect_end()
    return Guard(text, body)


class _Parser(Terms):
    """Terms and comparisons joined by and, or, not; parentheses hold any of it."""

    def group(self) -> Expression:
        return self.disjunction()

    def disjunction(self) -> Expression:
        left = self.conjunction()
        while token := self.take("or"):
            left = make.logic(token, left, self.conjunction())
        return left

    def conjunction(self) -> Expression:
        left = self.negation()
        while token := self.take("and"):
            left = make.logic(token, left, self.negation())
        return left

    def negation(self) -> Expression:
        with self.nested():
            token = self.take("not")
            return make.negation(token, self.negation()) if token else self.comparison()
