import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

from executive.core.errors import RecordError
from executive.core.types import (
    Call,
    Point,
    PoseEstimate,
    Reason,
    Segment,
)
from executive.record import (
    History,
    TruthRecorder,
    digest,
    read_record,
)
from executive.record.events import (
    AnnotationsEvent,
    Box,
    Command,
    DeviceReading,
    FaultArmedEvent,
    FaultEvent,
    HypothesesEvent,
    ImageEvent,
    Level,
    LogEvent,
    NodeChange,
    Placed,
    PlacedEvent,
    Resumed,
    Rock,
    RouteEvent,
    SegmentEvent,
    Spot,
    Start,
    Stop,
    StrategyEvent,
    Telemetry,
    TerrainEvent,
    TruthEvent,
    Verdict,
    WaypointEvent,
)
from executive.record.recorder import Recorder
from executive.record.topics import RECORD, TRUTH
from executive.record.versions import versions

SEGMENT = Segment(Point(1.0, 0.1), Point(2.0, -0.3), 0.03, 0.25, 0.02, 1)
POSE = PoseEstimate(
    12.0, (1.0, 2.0, 0.1), (0.0, 0.0, 0.6, 0.8), np.arange(36.0).reshape(6, 6) / 7, "markers", markers=3
).on(SEGMENT)
EVENTS = (
    DeviceReading("battery", {"charge": 0.75, "power": -12.5}),
    Start("trip", "scenario: trip\n", 7, 1.0, "geometric", {"numpy": "2", "longarm": "1"}),
    NodeChange("a/b", "failure", "not_seen", "2 of 4"),
    Command("tracks", "drive", {"left_m": 0.1, "right_m": -0.1 / 3}),
    POSE,
    HypothesesEvent({"nominal": 0.9, "slip": 0.1}, 321.5),
    HypothesesEvent({}, None),
    StrategyEvent("back_off", "stuck", 0.6, 2, Verdict.HELPED, "it moved"),
    Telemetry(*(0.1 * k for k in range(12)), True),
    RouteEvent((SEGMENT, SEGMENT)),
    SegmentEvent(SEGMENT),
    SegmentEvent(None),
    WaypointEvent(2, Point(2.0, -0.3), POSE),
    TerrainEvent((-1.0, 2.0), 0.05, np.arange(6, dtype=np.float32).reshape(2, 3), (Rock(1, 2, 0.1),)),
    ImageEvent("left", "png", b"\x89PNG\x00"),
    AnnotationsEvent("right", "N 8", (Box(1, 2, 3.5, 4),), (Spot(0, 1.5, 2),), (Spot(3, 9.0, 8.25),)),
    FaultArmedEvent("led_off", "storm"),
    FaultEvent("led_off", True, "marker_lost"),
    PlacedEvent("rock", (Placed("rock", 1.0, 0.1, 0.05),)),
    PlacedEvent("rock", ()),
    Call(5.0, Reason.NO_STRATEGY, "why", {"tilt_rad": 0.2}),
    LogEvent(Level.WARNING, "pool", "none left"),
    Stop("help", "no_strategy", "x"),
    Stop("reached"),
    Resumed(2),
)
TRUTH_EVENTS = (TruthEvent((1, 2, 3), (0, 0, 0, 1), 0.1, slip_left=0.3), FaultEvent("rock", True))


def write(path: Path, events=EVENTS, recorder=Recorder, close: bool = True):
    writer = recorder(path)
    for k, event in enumerate(events):
        writer.write(event, 1.5 * k)
        writer.flush()
    if close:
        writer.close()
    return writer


def same(a: object, b: object) -> bool:
    """Equal in every field, arrays included."""
    if isinstance(a, np.ndarray):
        return isinstance(b, np.ndarray) and a.dtype == b.dtype and np.array_equal(a, b)
    if hasattr(a, "__dataclass_fields__"):
        return type(a) is type(b) and all(same(getattr(a, n), getattr(b, n)) for n in a.__dataclass_fields__)
    return type(a) is type(b) and a == b


@pytest.mark.parametrize("event", EVENTS, ids=lambda e: type(e).__name__)
def test_every_event_comes_back_as_it_was_written(event, tmp_path):
    write(tmp_path / "r.mcap", [event])
    (found,) = [m for m in read_record(tmp_path / "r.mcap") if m.event() is not None]
    assert same(found.event(), event)


@pytest.mark.parametrize("event", TRUTH_EVENTS, ids=lambda e: type(e).__name__)
def test_truth_comes_back_as_it_was_written(event, tmp_path):
    write(tmp_path / "t.mcap", [event], TruthRecorder)
    (found,) = list(read_record(tmp_path / "t.mcap"))
    assert found.event() == event
    assert found.topic.startswith("/truth/")


def test_every_topic_is_tried_here():
    tried = {type(e) for e in EVENTS} | {type(e) for e in TRUTH_EVENTS}
    assert {t.event for t in RECORD + TRUTH if t.event} == tried


def test_record_refuses_what_has_no_topic(tmp_path):
    with Recorder(tmp_path / "r.mcap") as recorder, pytest.raises(TypeError, match="got a TruthEvent"):
        recorder.write(TRUTH_EVENTS[0], 0.0)


def test_record_cut_at_any_byte_reads_as_a_prefix(tmp_path):
    whole = tmp_path / "whole.mcap"
    write(whole)
    everything = [(m.topic, m.time_ns, m.payload) for m in read_record(whole)]
    content = whole.read_bytes()
    cut = tmp_path / "cut.mcap"
    seen = set()
    for size in range(0, len(content), 1 if len(content) < 20_000 else 7):
        cut.write_bytes(content[:size])
        found = [(m.topic, m.time_ns, m.payload) for m in read_record(cut)]
        assert found == everything[: len(found)]
        seen.add(len(found))
    assert seen == set(range(len(everything) + 1))


@given(st.data())
@settings(max_examples=60, deadline=None)
def test_damaged_record_never_raises(tmp_path_factory, data):
    whole = tmp_path_factory.mktemp("damage") / "r.mcap"
    write(whole, EVENTS[:6])
    content = bytearray(whole.read_bytes())
    at = data.draw(st.integers(0, len(content) - 1))
    content[at] ^= data.draw(st.integers(1, 255))
    whole.write_bytes(content)
    for message in read_record(whole):
        message.event()


def test_missing_record_is_said_to_be_missing(tmp_path):
    with pytest.raises(RecordError, match="no such record"):
        list(read_record(tmp_path / "none.mcap"))


def test_same_events_give_the_same_digest(tmp_path):
    writer = write(tmp_path / "a.mcap")
    write(tmp_path / "b.mcap")
    assert digest(tmp_path / "a.mcap") == digest(tmp_path / "b.mcap") == writer.digest


def test_digest_does_not_depend_on_how_the_file_is_closed(tmp_path):
    writer = write(tmp_path / "a.mcap", close=False)
    before = digest(tmp_path / "a.mcap")
    writer.close()
    assert digest(tmp_path / "a.mcap") == before


@pytest.mark.parametrize("left_out", range(len(EVENTS)))
def test_digest_changes_with_any_event_left_out(left_out, tmp_path):
    write(tmp_path / "a.mcap")
    write(tmp_path / "b.mcap", EVENTS[:left_out] + EVENTS[left_out + 1 :])
    assert digest(tmp_path / "a.mcap") != digest(tmp_path / "b.mcap")


def test_digest_changes_with_time_and_with_the_last_bit_of_a_value(tmp_path):
    digests = set()
    for name, value, time_s in (("a", 0.1, 1.0), ("b", np.nextafter(0.1, 1), 1.0), ("c", 0.1, 1.000000001)):
        with Recorder(tmp_path / f"{name}.mcap") as recorder:
            recorder.write(Command("head", "point", {"pan_rad": float(value)}), time_s)
            digests.add(recorder.digest)
    assert len(digests) == 3


def test_finished_record_opens_in_a_generic_reader(tmp_path):
    write(tmp_path / "r.mcap")
    with (tmp_path / "r.mcap").open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        summary = reader.get_summary()
        assert summary is not None
        assert summary.statistics.message_count == len(list(read_record(tmp_path / "r.mcap")))
        decoded = {channel.topic: message for _, channel, _, message in reader.iter_decoded_messages()}
    assert decoded["/telemetry"].right_current_a == pytest.approx(0.3)
    assert decoded["/estimate"].covariance.shape == [6, 6]
    assert decoded["/pose"].frame_id == "site"
    assert decoded["/image/left"].format == "png"
    assert decoded["/command"].values["left_m"] == 0.1


def test_killed_writer_leaves_all_it_flushed(tmp_path):
    script = (
        "import os, signal, sys; from pathlib import Path\n"
        "from executive.record.recorder import Recorder\n"
        "from executive.record.events import NodeChange\n"
        "r = Recorder(Path(sys.argv[1]))\n"
        "for k in range(50):\n    r.write(NodeChange('a', str(k)), float(k)); r.flush()\n"
        "os.kill(os.getpid(), signal.SIGKILL)\n"
    )
    died = subprocess.run([sys.executable, "-c", script, str(tmp_path / "r.mcap")], check=False)
    assert died.returncode == -9
    history = History.of(tmp_path / "r.mcap")
    assert [at.event.status for at in history.all(NodeChange)] == [str(k) for k in range(50)]
    assert not history.complete


def test_finished_record_is_known_to_be_complete(tmp_path):
    write(tmp_path / "r.mcap")
    assert History.of(tmp_path / "r.mcap").complete


def test_versions_name_what_is_installed_and_nothing_else():
    assert versions(("numpy", "no-such-package-anywhere")) == {"numpy": np.__version__}
