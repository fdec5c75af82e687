"""The kind of strategy that the pool can choose, and what each must keep."""

from __future__ import annotations

from collections.abc import Iterator

from executive.config.validate import guess
from executive.core.registry import Kind
from executive.core.types import Reason
from executive.isc import NOMINAL, hypothesis_names
from executive.pool.strategy import Strategy


def broken_promises(strategy: Strategy) -> Iterator[str]:
    """A sentence for each promise not kept. What is in the tree is checked where it is loaded."""
    if not strategy.name.isidentifier():
        yield f"got the name {strategy.name!r}, expected an identifier"
    if not strategy.doc.strip():
        yield "it does not say what it does (doc)"
    if not strategy.tree.is_file():
        yield f"tree file not found: {strategy.tree} (is it in package-data?)"
    if not strategy.answers and not strategy.reasons:
        yield "it answers nothing: no hypothesis, no reason"
    yield from _unknown(strategy)
    for what, fit in [*strategy.answers.items(), *strategy.reasons.items()]:
        if not 0.0 < fit <= 1.0:
            yield f"got the fitness {fit} for {what}, expected one in (0, 1]"
    if not strategy.cost_s > 0.0:
        yield f"got a cost of {strategy.cost_s} s, expected more than 0"
    if not strategy.excursion_m >= 0.0:
        yield f"got an excursion of {strategy.excursion_m} m, expected 0 or more"
    if strategy.tries_per_segment < 1:
        yield f"got {strategy.tries_per_segment} tries per segment, expected 1 or more"


def _unknown(strategy: Strategy) -> Iterator[str]:
    known = hypothesis_names()
    for name in strategy.answers:
        if name == NOMINAL:
            yield "it answers nominal, about which nothing is to be done"
        elif name not in known:
            yield f"it answers the unknown hypothesis {name!r}{guess(name, known)}"
    for reason in strategy.reasons:
        if not isinstance(reason, Reason):
            yield f"it answers the reason {reason!r}, expected a Reason"


STRATEGY_KIND: Kind[Strategy] = Kind(
    "strategy", "strategies", "A recovery method that the pool can choose.", Strategy, check=broken_promises
)
