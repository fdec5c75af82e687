"""Random formulas over x and y, as text for ourselves and for rtamt: the same tree, written twice."""

from dataclasses import dataclass

import numpy as np

from executive.core.values import NUMBER

TYPES = {"x": NUMBER, "y": NUMBER}
_TERMS = ("x", "y", "abs(x)", "x + y", "x - 2 * y", "x * y", "-y")


@dataclass(frozen=True)
class Written:
    """One formula in both notations; bounds are whole seconds."""

    ours: str
    theirs: str


def formula(rng: np.random.Generator, depth: int, longest_s: int = 12) -> Written:
    """A random formula of at most this many levels of operators."""
    if depth == 0 or rng.random() < 0.1:
        return _atom(rng)
    kind = rng.choice(["not", "and", "or", "implies", "always", "eventually", "until", "until"])
    left = formula(rng, depth - 1, longest_s)
    if kind == "not":
        return Written(f"not ({left.ours})", f"not ({left.theirs})")
    ours, theirs = _bounds(rng, longest_s)
    if kind in ("always", "eventually"):
        return Written(f"{kind}{ours} ({left.ours})", f"{kind}{theirs} ({left.theirs})")
    right = formula(rng, depth - 1, longest_s)
    if kind == "until":
        return Written(
            f"({left.ours}) until{ours} ({right.ours})", f"({left.theirs}) until{theirs} ({right.theirs})"
        )
    return Written(f"({left.ours}) {kind} ({right.ours})", f"({left.theirs}) {kind} ({right.theirs})")


def _atom(rng: np.random.Generator) -> Written:
    term, limit = rng.choice(_TERMS), f"{rng.uniform(0, 1.5):.3f}"
    sign = rng.choice(["<", "<=", ">", ">=", "==", "!="], p=[0.24, 0.24, 0.24, 0.22, 0.03, 0.03])
    theirs = term.replace("-y", "(0 - y)") if term == "-y" else term
    return Written(f"{term} {sign} {limit}", f"({theirs}) {'!==' if sign == '!=' else sign} {limit}")


def _bounds(rng: np.random.Generator, longest_s: int) -> tuple[str, str]:
    if rng.random() < 0.2:
        return "", ""
    first, last = sorted(int(s) for s in rng.integers(0, longest_s, size=2))
    return f"[{first} s, {last} s]", f"[{first}:{last}]"
