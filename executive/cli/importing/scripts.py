"""Scripts of BehaviorTree.CPP's preconditions → expressions of our guards."""

from __future__ import annotations

import re

from executive.tree.expressions.guards import parse_guard
from executive.tree.expressions.typed import FUNCTIONS, GuardError

_TOKEN = re.compile(r"'[^']*'|\"[^\"]*\"|\{[^}]*\}|&&|\|\||!=|!|[A-Za-z_@][\w.@]*|\d[\w.]*|\s+|.")
_WORDS = {"&&": " and ", "||": " or ", "!": " not "}
_KEPT = frozenset({"and", "or", "not", "true", "false", *FUNCTIONS})


def expression(script: str) -> str:
    """The guard that says the same: our own kept as it is, else operators and variables translated.

    GuardError where a guard cannot say it: assignments, several statements, the ternary operator, bits.
    """
    try:
        return parse_guard(script).text
    except GuardError:
        translated = " ".join("".join(_translated(token) for token in _TOKEN.findall(script)).split())
    try:
        return parse_guard(translated).text
    except GuardError:
        message = f'got the script "{script}", which a guard cannot say; expected a condition such as a < 3'
        raise GuardError(0, message) from None


def _translated(token: str) -> str:
    if token in _WORDS:
        return _WORDS[token]
    if re.fullmatch(r"[A-Za-z_][\w.]*", token) and token not in _KEPT:
        return f"{{{token}}}"
    return token
