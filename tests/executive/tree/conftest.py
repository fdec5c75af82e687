"""What the tree tests share: services with a clock and a scripted pool, leaves that keep a diary."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from executive.core.clock import Clock
from executive.core.devices import CABIN, TRACKS
from executive.core.errors import ConfigError
from executive.core.ports import Devices
from executive.core.types import (
    CabinReading,
    Outcome,
    PoseEstimate,
    Reason,
)
from executive.core.values import (
    INTEGER,
    LENGTH,
    POINT,
    POSE,
    SEGMENT,
    TEXT,
)
from executive.isc import Assessment, Readings
from executive.pool import Situation
from executive.tree.build import build
from executive.tree.catalogue import node_types
from executive.tree.load import load_tree_text
from executive.tree.nodes.base import (
    FromTree,
    In,
    InOut,
    Leaf,
    Out,
)


class Act(Leaf):
    """Run for some ticks, then end with a reason; note what happens in the diary."""

    ticks = In(INTEGER, "ticks under way", default=0)
    reason = In(TEXT, "how it ends", default="done")
    say = In(TEXT, "what to note", default="")

    def begin(self) -> None:
        self.services.diary.append(f"begin {self.say or self.name}")
        self.left = self.ticks

    def step(self) -> Outcome[object] | None:
        if self.reason == "raise" and self.left == 0:
            raise ValueError("broken")
        self.left -= 1
        return None if self.left >= 0 else Outcome(Reason(self.reason), "as told")

    def halt(self) -> None:
        self.services.diary.append(f"halt {self.say or self.name}")


class Note(Leaf):
    """Note a length in the diary."""

    value = In(LENGTH, "what to note", default=FromTree("length"))

    def step(self) -> Outcome[object]:
        self.services.diary.append(self.value)
        return Outcome(Reason.DONE)


class Visit(Leaf):
    """Note the end of a segment."""

    target = In(POINT, "where to")
    segment = In(SEGMENT, "the segment under way", default=FromTree("segment"))

    def step(self) -> Outcome[object]:
        self.services.diary.append((self.target, self.segment and self.segment.index))
        return Outcome(Reason.DONE)


class Measure(Leaf):
    """Write a length."""

    value = Out(LENGTH, "what was measured")

    def step(self) -> Outcome[object]:
        self.value = 0.25
        return Outcome(Reason.DONE)


class See(Leaf):
    """Read and write a pose."""

    pose = InOut(POSE, "the pose")

    def step(self) -> Outcome[object]:
        return Outcome(Reason.DONE)


TYPES = node_types((Act, Note, Visit, Measure, See))


class ScriptedPool:
    """Chooses the names given, in turn; keeps what it was asked with and what came of it."""

    def __init__(self, *names: str | None) -> None:
        self.names, self.failures, self.at_hand, self.helped = list(names), [], [], []

    def choose(self, situation: Situation, at_hand: frozenset[str]) -> Any:
        self.failures.append(situation.failure)
        self.at_hand.append(at_hand)
        return SimpleNamespace(strategy=self.names.pop(0) if self.names else None)

    def conclude(self, helped: bool, along_m: float | None = None) -> None:
        self.helped.append(helped)


def services(pool: Any = None) -> Any:
    """The few services that these leaves and a choice use."""
    pose = PoseEstimate(0.0, (0.0, 0.0, 0.0), (0, 0, 0, 1), [[0.0] * 6] * 6, "markers")
    assessment = Assessment(0.0, {}, None, None)
    return SimpleNamespace(
        clock=Clock(1.0),
        pool=pool or ScriptedPool(),
        diary=[],
        devices=Devices(
            TRACKS.fit(SimpleNamespace(stop=lambda: None)),
            CABIN.fit(SimpleNamespace(read=lambda: CabinReading(0.0, 0.0, 0.0, False))),
        ),
        classification=SimpleNamespace(
            predicted=lambda: pose,
            extrapolate=lambda pose, segment: assessment,
            tracker=SimpleNamespace(readings=Readings(), doubt=None),
        ),
        journal=SimpleNamespace(),
    )


class Bench:
    """Loads trees of the test leaves from text, builds and ticks them."""

    def __init__(self) -> None:
        self.services = services()

    def load(self, text: str):
        return load_tree_text(text, "t.yaml", TYPES)

    def problems(self, text: str) -> list[str]:
        with pytest.raises(ConfigError) as caught:
            self.load(text)
        return str(caught.value).splitlines()

    def build(self, root: str, pool: Any = None, strategies: Any = None, ports: str = "{}", **inputs: Any):
        self.services = services(pool)
        made = {name: self.load(text) for name, text in (strategies or {}).items()}
        spec = self.load(f"tree: t\nports: {ports}\nroot: {root}\n")
        return build(spec, self.services, inputs, made)

    def run(self, tree: Any, ticks: int = 100) -> str:
        """Tick until the end (or so often); the last status."""
        for _ in range(ticks):
            tree.root.tick_once()
            self.services.clock.advance()
            if tree.root.status.value != "RUNNING":
                break
        return tree.root.status.value

    @property
    def diary(self) -> list[Any]:
        return self.services.diary


@pytest.fixture
def bench() -> Bench:
    return Bench()
