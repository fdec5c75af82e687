"""No leaf waits for ever: what is silent is given up, each in its own time."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import pytest

from executive.core.types import Outcome, Point, Reason
from executive.testing import Bench
from executive.testing.bench import ROUTE
from executive.tree.catalogue import node_types
from executive.tree.nodes.base import Leaf
from executive.tree.nodes.watch_motion import BUDGET_S, PATIENCE_S

SPEED_M_S = 0.0014
START = ROUTE[0].start
RANGE_M = math.hypot(START.x_m, START.y_m)
AHEAD = Point(START.x_m * (1 + 0.2 / RANGE_M), START.y_m * (1 + 0.2 / RANGE_M))
ASIDE = ROUTE[0].end
LEAF_TYPES: dict[str, type[Leaf]] = {name: kind.leaf for name, kind in node_types().items() if kind.leaf}


def drive_s(belt_m: float) -> float:
    """Twice the time of a drive of so much way and 10 s, 10 s of patience, and half as much way for slip."""
    return 2 * 1.5 * belt_m / SPEED_M_S + 10 + 10


WAITS: dict[str, tuple[dict[str, Any], float, Reason]] = {
    "wait": ({"duration": 70.0}, 70, Reason.DONE),
    "localise": ({}, 5 + 900 + 300, Reason.TIMEOUT),
    "point_head": ({}, 600, Reason.DEVICE),
    "take_picture": ({}, 600, Reason.DEVICE),
    "set_cabin": ({}, 600, Reason.DEVICE),
    "show_markers": ({}, 600, Reason.DEVICE),
    "drive_straight": ({"distance": 0.1}, drive_s(0.1), Reason.DEVICE),
    "drive_blind": ({"target": AHEAD}, drive_s(0.2), Reason.DEVICE),
    "drive_leg": ({"target": AHEAD}, drive_s(0.1), Reason.DEVICE),
    "turn_towards": ({"target": ASIDE}, drive_s(math.pi * 0.125 / 2), Reason.DEVICE),
    "measure_arrival": ({"target": START, "within": 0.001}, 5 + 900 + 300, Reason.TIMEOUT),
    "call_for_help": ({}, 6 * 3600, Reason.NO_STRATEGY),
}
"""Each leaf that waits: its ports, the longest it may take [s], and what it then ends with."""

NEVER_ENDS = {"watch_motion"}  # looks on beside a drive, which has a patience of its own


@dataclass
class Silent:
    """A device that takes every order and answers none; `cancelled` counts those that were called off."""

    asked: list[tuple[Any, ...]] = field(default_factory=list)
    cancelled: int = 0

    def __call__(self, *order: Any) -> Silent:
        self.asked.append(order)
        return self

    def poll(self) -> None:
        return None

    def cancel(self) -> None:
        self.cancelled += 1


def silenced() -> tuple[Bench, Silent]:
    """A bench on which nothing that is begun ever ends."""
    bench, silent = Bench(), Silent()
    devices = bench.backend.devices
    orders = {"drive": "drive", "cabin": "move", "head": "point", "cameras": "take", "link": "call"}
    for device, order in orders.items():
        setattr(devices.named(device), order, silent)
    bench.services.localizer.locate = silent
    return bench, silent


def run(bench: Bench, name: str, **values: Any) -> tuple[Outcome[object], int]:
    pose = bench.services.classification.predicted().on(ROUTE[0])
    given = {"pose": pose, "segment": ROUTE[0], **values}
    ports = {port.name for port in LEAF_TYPES[name].ports()}
    values = {port: value for port, value in given.items() if port in ports}
    ended = bench.run(LEAF_TYPES[name], at_most=30_000, **values)
    return ended.outcome, ended.ticks


def test_every_leaf_that_takes_time_has_its_patience_in_the_table():
    own = {name for name, leaf in LEAF_TYPES.items() if leaf.__module__.startswith("executive.")}
    assert {name for name in own if LEAF_TYPES[name].takes_time()} == set(WAITS) | NEVER_ENDS


@pytest.mark.parametrize("name", WAITS)
def test_a_leaf_gives_up_what_never_answers(name):
    values, longest_s, reason = WAITS[name]
    bench, silent = silenced()
    outcome, ticks = run(bench, name, **values)
    assert outcome.reason is reason
    assert outcome.reason in LEAF_TYPES[name].outcomes
    assert ticks <= longest_s + 2
    assert silent.cancelled == len(silent.asked)


def fallen_silent() -> Bench:
    """A silenced bench whose belts' last reading grows old: nothing but patience ends a drive there."""
    bench, _ = silenced()
    drive = bench.backend.devices.named("drive")
    last = drive.read()
    drive.read = lambda: last
    return bench


@pytest.mark.parametrize("name", sorted(set(WAITS) - {"wait"}))
def test_a_leaf_has_no_less_patience_than_the_tree_gives_it(name):
    values, _, reason = WAITS[name]
    short, long = (run(fallen_silent(), name, patience=patience_s, **values) for patience_s in (20.0, 900.0))
    assert (short[0].reason, long[0].reason) == (reason, reason)
    assert long[1] - short[1] == 880


def test_a_call_that_nobody_answers_says_so():
    outcome, _ = run(silenced()[0], "call_for_help")
    assert outcome.detail.endswith("(no answer after 21600 s)")


def test_a_look_that_never_ends_is_followed_by_another():
    bench, silent = silenced()
    ended = bench.run(LEAF_TYPES["watch_motion"], at_most=1000)
    assert ended.ticks == 1000
    assert len(silent.asked) == silent.cancelled == math.ceil(1000 / (BUDGET_S + PATIENCE_S + 1))
