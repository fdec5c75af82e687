"""The arithmetic of expressions, from text: tokens, sums and products of numbers, names, abs/min/max.

Guards and temporal formulas both stand on it; each adds its own words for true and false.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from contextlib import contextmanager

from executive.config.validate import guess
from executive.core import units
from executive.core.units import UnitError
from executive.tree.expressions import typed as make
from executive.tree.expressions.typed import (
    FUNCTIONS,
    Expression,
    GuardError,
    Token,
)

MAX_DEPTH = 40
LOGIC = frozenset({"and", "or", "not", "implies", "always", "eventually", "until"})
COMPARISONS = ("<", "<=", ">", ">=", "==", "!=")

_KEYWORDS = LOGIC | {"true", "false", "abs", "max"}
_TOKEN = re.compile(
    r"(?P<space>\s+)"
    r"|(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,3})?)"
    r"|(?P<reference>\{\s*[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)*\s*\})"
    r"|(?P<text>'[^']*'|\"[^\"]*\")"
    r"|(?P<word>[A-Za-z_µ°%]\w*(?:/[A-Za-z]+)?)"
    r"|(?P<operator><=|>=|==|!=|->|[-+*/<>(),\[\]])"
)


def _tokens(text: str) -> Iterator[Token]:
    position = 0
    while position < len(text):
        match = _TOKEN.match(text, position)
        if match is None or match.lastgroup is None:
            raise GuardError(position, f"got {text[position]!r}, expected an expression like {{x}} < 30 mm")
        if match.lastgroup != "space":
            yield Token(match.lastgroup, match.group(), position)
        position = match.end()


class Terms:
    """Recursive descent, one token ahead. `names` may stand without braces."""

    def __init__(self, text: str, names: Iterable[str] = ()) -> None:
        self.tokens, self.position, self.depth = list(_tokens(text)), 0, 0
        self.names = frozenset(names)
        self.end = Token("end", "the end", len(text))

    def group(self) -> Expression:
        """What may stand in parentheses, and between the commas of a call."""
        return self.sum()

    @property
    def token(self) -> Token:
        return self.tokens[self.position] if self.position < len(self.tokens) else self.end

    def take(self, *texts: str) -> Token | None:
        token = self.token
        if token.kind in ("operator", "word") and token.text in texts:
            self.position += 1
            return token
        return None

    def must(self, text: str) -> None:
        if self.take(text) is None:
            raise GuardError(self.token.offset, f"got {self.token.text!r}, expected {text!r}")

    def expect_end(self) -> None:
        if self.token is not self.end:
            raise GuardError(self.token.offset, f"got {self.token.text!r}, expected the end or an operator")

    @contextmanager
    def nested(self) -> Iterator[None]:
        """One level deeper; GuardError where that is too deep to be meant."""
        self.depth += 1
        if self.depth > MAX_DEPTH:
            raise GuardError(self.token.offset, f"nested deeper than {MAX_DEPTH} levels")
        yield
        self.depth -= 1

    def comparison(self) -> Expression:
        terms, signs = self.compared()
        return make.comparison(terms, signs) if signs else terms[0]

    def compared(self) -> tuple[list[Expression], list[Token]]:
        """The terms of a chain of comparisons, and the signs between them (none: a term by itself)."""
        terms, signs = [self.sum()], []
        while token := self.take(*COMPARISONS):
            signs.append(token)
            terms.append(self.sum())
        return terms, signs

    def sum(self) -> Expression:
        left = self.product()
        while token := self.take("+", "-"):
            left = make.addition(token, left, self.product())
        return left

    def product(self) -> Expression:
        left = self.unary()
        while token := self.take("*", "/"):
            left = make.product(token, left, self.unary())
        return left

    def unary(self) -> Expression:
        negative = False
        while token := self.take("-", "+"):
            negative ^= token.text == "-"
        made = self.primary()
        return make.negative(made) if negative else made

    def primary(self) -> Expression:
        token = self.token
        self.position += 1
        match token.kind:
            case "number":
                return self.number(token)
            case "reference":
                return make.reference(token)
            case "text":
                return make.constant(token.offset, token.text[1:-1], "text")
            case "word" if token.text in ("true", "false"):
                return make.constant(token.offset, token.text == "true", "flag")
            case "word" if token.text in FUNCTIONS:
                return self.call(token)
            case "word" if token.text in self.names:
                return make.reference(token)
            case "operator" if token.text == "(":
                inner = self.group()
                self.must(")")
                return inner
        word = token.kind == "word"
        if self.names:
            hint, value = guess(token.text, self.names) if word else "", "signal"
        else:
            hint, value = f"; did you mean {{{token.text}}}?" if word else "", "{value}"
        raise GuardError(token.offset, f"got {token.text!r}, expected a number, a {value} or (...){hint}")

    def number(self, token: Token) -> Expression:
        unit, following = self.token, self.tokens[self.position + 1 : self.position + 2]
        is_call = bool(following) and following[0].text == "("
        if unit.kind != "word" or unit.text in _KEYWORDS or is_call:
            return make.constant(token.offset, float(token.text), units.PLAIN)
        self.position += 1
        try:
            value, kind = units.parse(f"{token.text} {unit.text}")
        except UnitError as error:
            raise GuardError(unit.offset, f"got {unit.text!r}, expected a unit ({error})") from None
        return make.constant(token.offset, value, kind)

    def call(self, token: Token) -> Expression:
        self.must("(")
        arguments = [self.group()]
        while self.take(","):
            arguments.append(self.group())
        self.must(")")
        if token.text == "abs" and len(arguments) != 1:
            raise GuardError(token.offset, f"got {len(arguments)} values for abs, expected one")
        return make.call(token, arguments)
