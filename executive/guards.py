"""Small safe expressions over the values of a tree: `abs({pose.cross_track}) < {segment.off_track}`.

Arithmetic, comparisons (also chained), and/or/not, abs/min/max, numbers with or without unit, quoted text,
true/false, and references in braces. Dimensions are checked when the tree is loaded. A value that is unset
(or not a number) at run time makes the guard *unknown*: `Guard.holds` then returns None.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from executive import expressions as make
from executive import units
from executive.config.validate import guess
from executive.expressions import FUNCTIONS, Expression, GuardError, Read, Token, UnknownValueError, kind_text
from executive.units import UnitError
from executive.values import ValueType

MAX_DEPTH = 40


@dataclass(frozen=True)
class Guard:
    """A parsed expression; `text` is as the file has it."""

    text: str
    body: Expression = field(compare=False)

    def holds(self, read: Read) -> bool | None:
        """True, False, or None where something it needs is unset."""
        try:
            return bool(self.body.evaluate(read))
        except (UnknownValueError, ZeroDivisionError, OverflowError):
            return None

    def check(self, types: Mapping[str, ValueType[Any]]) -> None:
        """GuardError unless every name, attribute and dimension fits and the whole is true or false."""
        kind = self.body.kind(types)
        if kind != "flag":
            raise GuardError(self.body.offset, f"got {kind_text(kind)}, expected something true or false")


def parse_guard(text: str, names: Iterable[str] = ()) -> Guard:
    """GuardError when the text is not such an expression. `names` may stand without braces."""
    parser = _Parser(list(_tokens(text)), len(text), frozenset(names))
    body = parser.disjunction()
    parser.expect_end()
    return Guard(text, body)


_TOKEN = re.compile(
    r"(?P<space>\s+)"
    r"|(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,3})?)"
    r"|(?P<reference>\{\s*[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)*\s*\})"
    r"|(?P<text>'[^']*'|\"[^\"]*\")"
    r"|(?P<word>[A-Za-z_µ°%]\w*(?:/[A-Za-z]+)?)"
    r"|(?P<operator><=|>=|==|!=|[-+*/<>(),])"
)
_KEYWORDS = {"and", "or", "not", "true", "false", "abs", "max"}


def _tokens(text: str) -> Iterator[Token]:
    position = 0
    while position < len(text):
        match = _TOKEN.match(text, position)
        if match is None or match.lastgroup is None:
            raise GuardError(position, f"got {text[position]!r}, expected an expression like {{x}} < 30 mm")
        if match.lastgroup != "space":
            yield Token(match.lastgroup, match.group(), position)
        position = match.end()


class _Parser:
    """Recursive descent, one token ahead."""

    def __init__(self, tokens: list[Token], length: int, names: frozenset[str] = frozenset()) -> None:
        self.tokens, self.position, self.depth = tokens, 0, 0
        self.names = names
        self.end = Token("end", "the end", length)

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
        self.depth += 1
        if self.depth > MAX_DEPTH:
            raise GuardError(self.token.offset, f"nested deeper than {MAX_DEPTH} levels")
        token = self.take("not")
        made = make.negation(token, self.negation()) if token else self.comparison()
        self.depth -= 1
        return made

    def comparison(self) -> Expression:
        terms, signs = [self.sum()], []
        while token := self.take("<", "<=", ">", ">=", "==", "!="):
            signs.append(token)
            terms.append(self.sum())
        return make.comparison(terms, signs) if signs else terms[0]

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
                inner = self.disjunction()
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
        arguments = [self.disjunction()]
        while self.take(","):
            arguments.append(self.disjunction())
        self.must(")")
        if token.text == "abs" and len(arguments) != 1:
            raise GuardError(token.offset, f"got {len(arguments)} values for abs, expected one")
        return make.call(token, arguments)
