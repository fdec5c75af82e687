"""The parts of a guard: each knows how to evaluate itself, and of what kind (dimension) it is."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import reduce
from typing import Any

import numpy as np

from executive.config.validate import guess, listed
from executive.core import units
from executive.core.common_units import Dimension
from executive.core.values import ValueType, attribute_of

Read = Callable[[str, tuple[str, ...]], Any]
"""Gives the value of a reference: its name and attributes."""

Kind = Dimension | str
"""What an expression yields: a number's dimension, or `flag`, `text`, or the name of an enumeration."""


class GuardError(ValueError):
    """What is wrong with an expression, and at which character of it."""

    def __init__(self, offset: int, message: str) -> None:
        self.offset, self.message = offset, message
        super().__init__(message)


class UnknownValueError(Exception):
    """Something asked for has no value now; the message says what."""


@dataclass(frozen=True)
class Expression:
    """A part of a guard: how to evaluate it, how to find its kind, and the references inside."""

    offset: int
    evaluate: Callable[[Read], Any] = field(compare=False)
    kind: Callable[[Mapping[str, ValueType[Any]]], Kind] = field(compare=False)
    references: tuple[tuple[int, str, tuple[str, ...]], ...] = ()


@dataclass(frozen=True)
class Token:
    kind: str
    text: str
    offset: int


def constant(offset: int, value: Any, kind: Kind) -> Expression:
    return Expression(offset, lambda read: value, lambda types: kind)


def reference(token: Token) -> Expression:
    name, *rest = token.text.strip("{} \t\n").split(".")
    attributes = tuple(rest)

    def evaluate(read: Read) -> Any:
        value = read(name, attributes)
        if value is None:
            raise UnknownValueError(f"{token.text} is not set")
        return _number(value, token.text)

    def kind(types: Mapping[str, ValueType[Any]]) -> Kind:
        return _reference_kind(token.offset, name, attributes, types)

    return Expression(token.offset, evaluate, kind, ((token.offset, name, attributes),))


def _number(value: Any, words: str) -> Any:
    """The value; UnknownValueError for a float that is not a number."""
    if isinstance(value, float | np.floating) and math.isnan(value):
        raise UnknownValueError(f"{words} is not a number")
    return value


def _reference_kind(
    offset: int, name: str, attributes: tuple[str, ...], types: Mapping[str, ValueType[Any]]
) -> Kind:
    if name not in types:
        known = sorted(types)
        message = f"got the unknown value {{{name}}}, expected {listed(known) or 'one of this tree'}"
        raise GuardError(offset, message + guess(name, known))
    try:
        found = attribute_of(types[name], attributes)
    except LookupError as error:
        wrong, owner, known_attributes = error.args
        expected = listed(known_attributes) or "none"
        message = f"got the unknown attribute {wrong!r} of a {owner}, expected {expected}"
        raise GuardError(offset, message + guess(wrong, known_attributes)) from None
    return _kind_of(offset, found)


def _kind_of(offset: int, found: ValueType[Any]) -> Kind:
    if found.python in (float, int):
        return units.dimension(found.unit or "")
    if found.python is bool:
        return "flag"
    if issubclass(found.python, str):
        return "text" if found.python is str else found.name
    raise GuardError(offset, f"got a {found.name}, expected a number: name an attribute of it")


def logic(token: Token, left: Expression, right: Expression) -> Expression:
    def evaluate(read: Read) -> bool:
        if token.text == "and":
            return bool(left.evaluate(read)) and bool(right.evaluate(read))
        return bool(left.evaluate(read)) or bool(right.evaluate(read))

    def kind(types: Mapping[str, ValueType[Any]]) -> Kind:
        for side in (left, right):
            _require_flag(side, types, token.text)
        return "flag"

    return Expression(left.offset, evaluate, kind, left.references + right.references)


def negation(token: Token, inner: Expression) -> Expression:
    def kind(types: Mapping[str, ValueType[Any]]) -> Kind:
        _require_flag(inner, types, "not")
        return "flag"

    return Expression(token.offset, lambda read: not inner.evaluate(read), kind, inner.references)


def _require_flag(side: Expression, types: Mapping[str, ValueType[Any]], word: str) -> None:
    if (found := side.kind(types)) != "flag":
        message = f"got {kind_text(found)} beside {word!r}, expected something true or false"
        raise GuardError(side.offset, message)


_COMPARE: dict[str, Callable[[Any, Any], bool]] = {
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "==": operator.eq,
    "!=": operator.ne,
}


def comparison(terms: list[Expression], signs: list[Token]) -> Expression:
    def evaluate(read: Read) -> bool:
        values = [_number(term.evaluate(read), "one side") for term in terms]
        pairs = zip(signs, values, values[1:], strict=False)
        return all(_COMPARE[sign.text](left, right) for sign, left, right in pairs)

    def kind(types: Mapping[str, ValueType[Any]]) -> Kind:
        kinds = [term.kind(types) for term in terms]
        for sign, left, right, term in zip(signs, kinds, kinds[1:], terms[1:], strict=False):
            _require_comparable(sign, left, right, term)
        return "flag"

    references = tuple(r for term in terms for r in term.references)
    return Expression(terms[0].offset, evaluate, kind, references)


def _require_comparable(sign: Token, left: Kind, right: Kind, term: Expression) -> None:
    words = {left, right} - {"text"}
    enumeration = "text" in (left, right) and len(words) == 1 and isinstance(next(iter(words)), str)
    if left != right and not (enumeration and "flag" not in words):
        got, expected = kind_text(right), kind_text(left)
        raise GuardError(term.offset, f"got {got}, expected {expected} to compare with {sign.text!r}")
    if isinstance(left, str) and sign.text not in ("==", "!="):
        raise GuardError(sign.offset, f"got {sign.text!r} between {kind_text(left)}s, expected == or !=")


def addition(token: Token, left: Expression, right: Expression) -> Expression:
    apply = operator.add if token.text == "+" else operator.sub

    def kind(types: Mapping[str, ValueType[Any]]) -> Kind:
        first = _number_kind(left, types)
        if (second := _number_kind(right, types)) != first:
            message = f"got {kind_text(second)}, expected {kind_text(first)} beside {token.text!r}"
            raise GuardError(right.offset, message)
        return first

    return _arithmetic(apply, left, right, kind)


def product(token: Token, left: Expression, right: Expression) -> Expression:
    apply = operator.mul if token.text == "*" else _divided
    sign = 1 if token.text == "*" else -1

    def kind(types: Mapping[str, ValueType[Any]]) -> Kind:
        powers = dict(_number_kind(left, types))
        if sign < 0 and _is_zero(right):
            raise GuardError(right.offset, "got a division by zero")
        for unit, power in _number_kind(right, types):
            powers[unit] = powers.get(unit, 0) + sign * power
        return tuple(sorted((unit, power) for unit, power in powers.items() if power))

    return _arithmetic(apply, left, right, kind)


def _divided(left: Any, right: Any) -> Any:
    """The quotient; ZeroDivisionError also for numbers of numpy, which only warn."""
    if not isinstance(right, np.ndarray) and right == 0:
        raise ZeroDivisionError
    return left / right


def _is_zero(term: Expression) -> bool:
    """Whether a term without references comes to zero."""
    if term.references:
        return False
    try:
        return bool(term.evaluate(lambda name, attributes: None) == 0)
    except (ArithmeticError, UnknownValueError):
        return False


def _arithmetic(
    apply: Callable[[Any, Any], Any],
    left: Expression,
    right: Expression,
    kind: Callable[[Mapping[str, ValueType[Any]]], Kind],
) -> Expression:
    references = left.references + right.references
    return Expression(
        left.offset, lambda read: apply(left.evaluate(read), right.evaluate(read)), kind, references
    )


def negative(inner: Expression) -> Expression:
    return Expression(
        inner.offset,
        lambda read: -inner.evaluate(read),
        lambda types: _number_kind(inner, types),
        inner.references,
    )


FUNCTIONS: dict[str, Callable[[list[Any]], Any]] = {
    "abs": lambda values: abs(values[0]),
    "min": lambda values: reduce(np.minimum, values) if _sampled(values) else min(values),
    "max": lambda values: reduce(np.maximum, values) if _sampled(values) else max(values),
}


def _sampled(values: list[Any]) -> bool:
    """Whether these are signals over time, to be taken sample by sample, not numbers."""
    return any(isinstance(value, np.ndarray) for value in values)


def call(token: Token, arguments: list[Expression]) -> Expression:
    function = FUNCTIONS[token.text]

    def evaluate(read: Read) -> Any:
        return function([argument.evaluate(read) for argument in arguments])

    def kind(types: Mapping[str, ValueType[Any]]) -> Kind:
        first = _number_kind(arguments[0], types)
        for other in arguments[1:]:
            if (found := _number_kind(other, types)) != first:
                raise GuardError(other.offset, f"got {kind_text(found)}, expected {kind_text(first)}")
        return first

    return Expression(token.offset, evaluate, kind, tuple(r for a in arguments for r in a.references))


def _number_kind(inner: Expression, types: Mapping[str, ValueType[Any]]) -> Dimension:
    kind = inner.kind(types)
    if isinstance(kind, str):
        raise GuardError(inner.offset, f"got {kind_text(kind)}, expected a number")
    return kind


def kind_text(kind: Kind) -> str:
    if isinstance(kind, str):
        return "true or false" if kind == "flag" else units.articled(kind)
    return units.articled(units.name_of(kind))
