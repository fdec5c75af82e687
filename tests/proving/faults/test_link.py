"""Faults of the link, around a link that answers after ten minutes, as far as it is called."""

from dataclasses import dataclass, field

import pytest

from executive.core.clock import Clock
from executive.core.devices import LINK
from executive.core.types import Call, Outcome, Reason
from proving.faults.altered import Unanswered
from proving.faults.link import (
    Corruption,
    Dropping,
    LinkCorrupt,
    LinkDelay,
    LinkDelayed,
    LinkDrop,
    LinkDuplicate,
    LinkOutage,
    Patience,
    Replay,
    ReplayedUplink,
)
from proving.faults.parameters import Nothing

CALL = Call(0.0, Reason.BLOCKED, "a rock")
ANSWER = "received: blocked; hold"


@dataclass
class Ground:
    """Answers every call ten minutes later."""

    clock: Clock
    calls: list[Call] = field(default_factory=list)

    def call(self, call):
        self.calls.append(call)
        return Unanswered(self.clock, 600.0, Outcome(Reason.DONE, "answer from ground", ANSWER))


@pytest.fixture
def ground(bench):
    return Ground(bench.robot.clock)


@pytest.fixture
def called(bench, ground):
    """Calls through a fault; the outcome, and how long it took."""

    def through(fault):
        devices = bench.robot.devices.replace(LINK, ground)
        begun_s = bench.robot.clock.now_s
        assert not fault.took_effect()
        outcome = bench.finish(fault.wrap(devices, bench.cue)[LINK].call(CALL))
        return outcome, bench.robot.clock.now_s - begun_s

    return through


FAULTS = [
    LinkDelay(LinkDelayed()),
    LinkDrop(Dropping()),
    LinkOutage(Patience()),
    LinkDuplicate(Nothing()),
    LinkCorrupt(Corruption(share=1.0)),
    ReplayedUplink(Replay()),
]


@pytest.mark.parametrize("fault", FAULTS, ids=lambda f: type(f).__name__)
def test_a_link_without_its_fault_answers_as_ever(bench, called, fault):
    bench.level.now = 0.0
    outcome, took_s = called(fault)
    assert (outcome.value, took_s, fault.took_effect()) == (ANSWER, 600.0, False)


def test_a_delayed_answer_comes_later(called):
    fault = LinkDelay(LinkDelayed(by="1200 s"))
    outcome, took_s = called(fault)
    assert (outcome.value, took_s, fault.took_effect()) == (ANSWER, 1800.0, True)


@pytest.mark.parametrize(
    "fault", [LinkDrop(Dropping(patience="900 s")), LinkOutage(Patience(patience="900 s"))]
)
def test_a_lost_call_never_reaches_ground_and_times_out(called, ground, fault):
    outcome, took_s = called(fault)
    assert (outcome.reason, took_s, ground.calls) == (Reason.TIMEOUT, 900.0, [])
    assert fault.took_effect()


def test_some_calls_get_through_a_link_that_drops_some(bench, ground):
    link = LinkDrop(Dropping(chance=0.5)).wrap(bench.robot.devices.replace(LINK, ground), bench.cue)[LINK]
    for _ in range(200):
        link.call(CALL)
    assert 70 < len(ground.calls) < 130


def test_an_outage_swallows_the_answer_to_a_call_made_before(bench, ground):
    fault = LinkOutage(Patience())
    bench.level.now = 0.0
    action = fault.wrap(bench.robot.devices.replace(LINK, ground), bench.cue)[LINK].call(CALL)
    bench.level.now = 1.0
    assert bench.finish(action).reason is Reason.TIMEOUT
    assert (ground.calls, fault.took_effect()) == ([CALL], True)


def test_a_duplicated_call_is_heard_twice_and_answered_once(called, ground):
    fault = LinkDuplicate(Nothing())
    outcome, _ = called(fault)
    assert (outcome.value, ground.calls, fault.took_effect()) == (ANSWER, [CALL, CALL], True)


def test_a_corrupted_answer_is_as_long_and_reads_otherwise(called):
    fault = LinkCorrupt(Corruption(share=0.5))
    outcome, _ = called(fault)
    assert outcome.value != ANSWER
    assert len(outcome.value) == len(ANSWER)
    assert fault.took_effect()


def test_a_replayed_answer_comes_at_once_without_ground(called, ground):
    fault = ReplayedUplink(Replay(answer="go on"))
    outcome, took_s = called(fault)
    assert (outcome.value, took_s, ground.calls, fault.took_effect()) == ("go on", 0.0, [], True)
