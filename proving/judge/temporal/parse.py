"""Text → formula: `always[5 s, 2 min] (moving implies tilt < 5 deg)`.

From loosest to tightest: implies (or ->), or, and, until, then not / always / eventually, then comparisons.
`implies` and `until` group to the right; a prefix takes the comparison or the parenthesis that follows.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from executive.core.units import DURATION, PLAIN, dimension
from executive.core.values import ValueType
from executive.record.signals import types as signal_types
from executive.tree.expressions.grammar import COMPARISONS, LOGIC, Terms
from executive.tree.expressions.typed import (
    Expression,
    GuardError,
    Token,
    kind_text,
)
from proving.judge.temporal.atoms import atom
from proving.judge.temporal.formula import (
    Always,
    And,
    Bounds,
    Eventually,
    Formula,
    Implies,
    Not,
    Or,
    Until,
)

NS = 1_000_000_000
LONGEST_S = 1e9  # no mission is that long, and nanoseconds still count
_FORMULA_WORDS = LOGIC | {"->", *COMPARISONS}
_MAKE: dict[str, Callable[[str, Formula, Formula], Formula]] = {"and": And, "or": Or}


def parse_formula(text: str, types: Mapping[str, ValueType[Any]] | None = None) -> Formula:
    """GuardError, with the character it is about, unless names, dimensions and bounds all fit.

    `types` are those of the names it may speak of (None: all signals).
    """
    parser = _Parser(text, signal_types() if types is None else types)
    formula = parser.formula()
    parser.expect_end()
    return formula


class _Parser(Terms):
    """Adds the words of temporal logic to terms; what is between two of them is an atom."""

    def __init__(self, text: str, types: Mapping[str, ValueType[Any]]) -> None:
        super().__init__(text, types)
        self.text, self.types = text, types

    def formula(self) -> Formula:
        start = self.token.offset
        with self.nested():
            left = self.chain("or", lambda: self.chain("and", self.until))
            if self.take("implies", "->") is None:
                return left
            right = self.formula()
        return Implies(self.since(start), left, right)

    def chain(self, word: str, inner: Callable[[], Formula]) -> Formula:
        start = self.token.offset
        left = inner()
        while self.take(word):
            right = inner()
            left = _MAKE[word](self.since(start), left, right)
        return left

    def until(self) -> Formula:
        start = self.token.offset
        with self.nested():
            left = self.prefixed()
            if self.take("until") is None:
                return left
            bounds = self.bounds()
            right = self.until()
        return Until(self.since(start), left, right, bounds)

    def prefixed(self) -> Formula:
        start = self.token.offset
        with self.nested():
            match self.take("not", "always", "eventually"):
                case Token(text="not"):
                    inner = self.prefixed()
                    return Not(self.since(start), inner)
                case Token(text="always"):
                    bounds, inner = self.bounds(), self.prefixed()
                    return Always(self.since(start), inner, bounds)
                case Token(text="eventually"):
                    bounds, inner = self.bounds(), self.prefixed()
                    return Eventually(self.since(start), inner, bounds)
            return self.primary_formula()

    def primary_formula(self) -> Formula:
        start = self.token.offset
        if self.token.text == "(" and self.token.kind == "operator" and self.holds_a_formula():
            self.must("(")
            inner = self.formula()
            self.must(")")
            return inner
        terms, signs = self.compared()
        return atom(self.since(start), terms, signs, self.types)

    def holds_a_formula(self) -> bool:
        """Whether the parenthesis that opens here is about true and false, not about numbers."""
        open_, position = 0, self.position
        for token in self.tokens[position:]:
            if token.kind in ("operator", "word"):
                open_ += {"(": 1, ")": -1}.get(token.text, 0)
                if token.text in _FORMULA_WORDS:
                    return True
                if open_ == 0:
                    return False
        return False

    def bounds(self) -> Bounds:
        opening = self.take("[")
        if opening is None:
            return Bounds()
        first_ns = self.duration_ns()
        self.must(",")
        last_ns = None if self.take("inf") else self.duration_ns()
        self.must("]")
        if last_ns is not None and last_ns < first_ns:
            message = f"got {self.since(opening.offset)}, expected the earlier bound first"
            raise GuardError(opening.offset, message)
        return Bounds(first_ns, last_ns)

    def duration_ns(self) -> int:
        token = self.token
        if token.kind != "number":
            raise GuardError(
                token.offset, f"got {token.text!r}, expected a duration such as {DURATION.example!r}"
            )
        self.position += 1
        given = self.number(token)
        kind = given.kind({})
        if kind != dimension(DURATION.unit):
            what = f"{token.text} without a unit" if kind == PLAIN else kind_text(kind)
            raise GuardError(token.offset, f"got {what}, expected a duration such as {DURATION.example!r}")
        return _value_ns(given)

    def since(self, start: int) -> str:
        """The text read from `start` up to here."""
        last = self.tokens[self.position - 1]
        return self.text[start : last.offset + len(last.text)]


def _value_ns(constant: Expression) -> int:
    seconds: float = constant.evaluate(lambda name, attributes: None)
    return round(min(seconds, LONGEST_S) * NS)
