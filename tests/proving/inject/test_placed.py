"""What faults put into the world is recorded, again once it has moved, and when it is gone."""

from itertools import pairwise
from types import SimpleNamespace

import pytest

from executive.record.events import Placed, PlacedEvent
from proving.inject.schedule import FaultSchedule, Injection, Level


@pytest.fixture
def written():
    return []


@pytest.fixture
def note(written):
    """Tells the schedule what a fault has lying in the world just now."""
    schedule = FaultSchedule(
        [], SimpleNamespace(backend=None, write=written.append, progress=lambda: 0.0, seed=0)
    )
    fault = SimpleNamespace(placed=lambda: fault.things, things=())
    plan = SimpleNamespace(name="rolling")
    injection = Injection(plan, fault, None, None, None, Level())

    def tell(*things):
        fault.things = things
        schedule._note_places(injection)

    return tell


def test_a_thing_is_written_when_it_comes_and_when_it_goes(note, written):
    rock = Placed("rock", 3.0, 0.1, 0.08)
    for things in ((), (rock,), (rock,), (), ()):
        note(*things)
    assert written == [PlacedEvent("rolling", (rock,)), PlacedEvent("rolling", ())]


def test_a_thing_that_rolls_is_written_every_few_centimetres(note, written):
    for n in range(61):
        note(Placed("rock", 3.0, 0.005 * n, 0.08))
    places = [event.things[0].y_m for event in written]
    assert places[0] == 0.0
    assert all(0.02 <= there - here < 0.03 for here, there in pairwise(places))
    assert places[-1] > 0.28
