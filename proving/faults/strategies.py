"""Faults of the pool's plug-ins: missing, wrong, slow."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Annotated

from py_trees.behaviour import Behaviour
from py_trees.common import Status
from pydantic import Field

from executive.core.units import Duration
from executive.pool import Situation, Strategy
from executive.run import Cue, FaultSpec
from proving.faults.altered import Counted
from proving.faults.parameters import Parameters
from proving.faults.reticked import NodeFault, Reticked


class StrategyName(Parameters):
    """Which strategy."""

    strategy: Annotated[str, Field(min_length=1, description="name of the strategy")]


class StrategyMissing(Counted):
    """The pool has to do without a strategy. Counted each time it would have been fit to be tried."""

    def __init__(self, parameters: StrategyName) -> None:
        self._name = parameters.strategy

    def wrap_pool(self, strategies: tuple[Strategy, ...], cue: Cue) -> tuple[Strategy, ...]:
        return tuple(self._unavailable(s, cue) if s.name == self._name else s for s in strategies)

    def _unavailable(self, strategy: Strategy, cue: Cue) -> Strategy:
        def needs(situation: Situation) -> str | None:
            refusal = strategy.needs(situation)
            if refusal is not None or not cue.active:
                return refusal
            self.altered += 1
            return "its plug-in is missing"

        return replace(strategy, needs=needs)


class StrategyWrong(NodeFault):
    """A strategy claims to have succeeded, and has done nothing."""

    def __init__(self, parameters: StrategyName) -> None:
        super().__init__(parameters.strategy)

    def tick(self, node: Reticked, cue: Cue) -> Iterator[Behaviour]:
        node.halt()
        self.altered += 1
        node.show(Status.SUCCESS)
        yield from ()


class Slowness(StrategyName):
    """Which strategy, and how long it takes to begin."""

    by: Annotated[Duration, Field(gt=0, le=864_000, description="mission time before it does anything")] = (
        1800.0
    )


class StrategySlow(NodeFault):
    """A strategy chosen does nothing for a while, and only then begins."""

    def __init__(self, parameters: Slowness) -> None:
        super().__init__(parameters.strategy)
        self._by_s = parameters.by
        self._begins: dict[str, int] = {}

    def tick(self, node: Reticked, cue: Cue) -> Iterator[Behaviour]:
        now, waiting = cue.clock.ticks, node.showing is Status.RUNNING and node.own is not Status.RUNNING
        if node.showing is not Status.RUNNING:
            self._begins[node.path] = now + cue.clock.ticks_for(self._by_s)
            waiting = True
        if waiting and now < self._begins[node.path]:
            self.altered += 1
            node.show(Status.RUNNING)
        else:
            yield from node.run()


STRATEGY_MISSING = FaultSpec(
    "strategy_missing",
    "A strategy's plug-in is missing, and the pool has to do without.",
    StrategyName,
    StrategyMissing,
    "",
    category="executive",
    strategy="strategy",
)
STRATEGY_WRONG = FaultSpec(
    "strategy_wrong",
    "A strategy claims to have succeeded without having done anything.",
    StrategyName,
    StrategyWrong,
    "",
    category="executive",
    strategy="strategy",
)
STRATEGY_SLOW = FaultSpec(
    "strategy_slow",
    "A strategy that was chosen does nothing for a while before it begins.",
    Slowness,
    StrategySlow,
    "",
    category="executive",
    strategy="strategy",
)
