"""Where two records part: when, on which topic, in which field."""

from __future__ import annotations

import pytest

from executive.core.errors import RecordError
from executive.record import events
from executive.record.divergence import first_divergence
from executive.record.recorder import Recorder


@pytest.fixture
def record(tmp_path):
    """Writes a record of (time, event) pairs; its path."""

    def write(name, *messages):
        path = tmp_path / f"{name}.mcap"
        with Recorder(path) as recorder:
            for time_s, event in messages:
                recorder.write(event, time_s)
        return path

    return write


def command(left_m, verb="drive"):
    return events.Command("tracks", verb, {"left_m": left_m, "right_m": 0.1})


def test_equal_records_do_not_part(record):
    messages = [(1.0, command(0.1)), (2.0, events.Stop("reached"))]
    assert first_divergence(record("a", *messages), record("b", *messages)) is None


def test_the_first_differing_field_is_named_with_both_values(record):
    old = record("a", (1.0, command(0.1)), (7.0, command(0.1)), (9.0, events.Stop("reached")))
    new = record("b", (1.0, command(0.1)), (7.0, command(0.2)), (9.0, events.Stop("help")))
    found = first_divergence(old, new)
    assert str(found) == "at 7 s, /command values[left_m]: recorded 0.1, repeated 0.2"


def test_a_message_that_comes_at_another_time_or_not_at_all_is_named(record):
    old = record("a", (1.0, command(0.1)), (7.0, command(0.1)))
    later = first_divergence(old, record("b", (1.0, command(0.1)), (8.0, command(0.1))))
    assert str(later) == "at 7 s, /command: recorded /command at 7 s, repeated /command at 8 s"
    short = first_divergence(old, record("c", (1.0, command(0.1))))
    assert str(short) == "at 7 s, /command: recorded /command at 7 s, repeated the end"


def test_elements_of_sequences_and_maps_are_named(record):
    box = events.Box(1.0, 2.0, 3.0, 4.0)
    old = record("a", (1.0, events.AnnotationsEvent("left", windows=(box, box))))
    new = record("b", (1.0, events.AnnotationsEvent("left", windows=(box, events.Box(1.0, 2.5, 3.0, 4.0)))))
    found = first_divergence(old, new)
    assert (found.topic, found.field, found.repeated) == ("/annotations/left", "windows[1].v", "2.5")
    old = record("c", (1.0, events.HypothesesEvent({"nominal": 1.0})))
    new = record("d", (1.0, events.HypothesesEvent({"nominal": 1.0, "stuck": 0.0})))
    assert first_divergence(old, new).field == "weights[stuck]"


def test_a_record_that_is_not_there_is_an_error(record, tmp_path):
    with pytest.raises(RecordError):
        first_divergence(record("a"), tmp_path / "none.mcap")
