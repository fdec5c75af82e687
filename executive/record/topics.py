"""The table of topics: which event goes where, and how it is written and read."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from foxglove_schemas_protobuf.CompressedImage_pb2 import CompressedImage
from foxglove_schemas_protobuf.ImageAnnotations_pb2 import ImageAnnotations
from foxglove_schemas_protobuf.Log_pb2 import Log
from foxglove_schemas_protobuf.PoseInFrame_pb2 import PoseInFrame
from google.protobuf.message import Message

from executive.core.types import Call, PoseEstimate
from executive.record import events, foxglove
from executive.record.codec import Codec


@dataclass(frozen=True)
class Topic:
    """One topic. `event` None marks a twin for viewers, never read back.

    `encode` takes the event and mission time [ns]; `suffix` picks the end of the name out of an event.
    """

    name: str
    event: type | None
    message: type[Message]
    encode: Callable[[Any, int], bytes]
    decode: Callable[[bytes], Any]
    suffix: Callable[[Any], str] = lambda event: ""


def _own(name: str, cls: type, suffix: Callable[[Any], str] = lambda event: "") -> Topic:
    """A topic with a schema made from the dataclass."""
    own: Codec[Any] = Codec(cls)
    return Topic(name, cls, own.message, lambda event, _: own.encode(event), own.decode, suffix)


def _fox(
    name: str,
    cls: type | None,
    message: type[Message],
    make: Callable[[Any, int], Message],
    read: Callable[[Any], Any],
    suffix: Callable[[Any], str] = lambda event: "",
) -> Topic:
    """A topic with a Foxglove schema."""
    return Topic(
        name,
        cls,
        message,
        lambda event, stamp_ns: make(event, stamp_ns).SerializeToString(deterministic=True),
        lambda payload: read(message.FromString(payload)),
        suffix,
    )


def _of_camera(event: events.ImageEvent | events.AnnotationsEvent) -> str:
    return f"/{event.camera}"


RECORD: tuple[Topic, ...] = (
    _own("/start", events.Start),
    _own("/stop", events.Stop),
    _own("/resumed", events.Resumed),
    _own("/node", events.NodeChange),
    _own("/command", events.Command),
    _own("/estimate", PoseEstimate),
    _fox("/pose", None, PoseInFrame, foxglove.pose_in_frame, lambda message: None),
    _own("/hypotheses", events.HypothesesEvent),
    _own("/strategy", events.StrategyEvent),
    _own("/telemetry", events.Telemetry),
    _own("/device", events.DeviceReading, lambda event: f"/{event.device}"),
    _own("/route", events.RouteEvent),
    _own("/segment", events.SegmentEvent),
    _own("/waypoint", events.WaypointEvent),
    _fox(
        "/image", events.ImageEvent, CompressedImage, foxglove.image_message, foxglove.image_event, _of_camera
    ),
    _fox(
        "/annotations",
        events.AnnotationsEvent,
        ImageAnnotations,
        foxglove.annotations_message,
        foxglove.annotations_event,
        _of_camera,
    ),
    _own("/call", Call),
    _own("/terrain", events.TerrainEvent),
    _own("/fault_armed", events.FaultArmedEvent),
    _own("/fault", events.FaultEvent),
    _own("/placed", events.PlacedEvent),
    _fox("/log", events.LogEvent, Log, foxglove.log_message, foxglove.log_event),
)
TRUTH: tuple[Topic, ...] = (
    _own("/truth/pose", events.TruthEvent),
    _own("/truth/fault", events.FaultEvent),
    _own("/truth/terrain", events.TerrainEvent),
)
# beside an event's own topic, what viewers want of it
TWINS: dict[type, str] = {PoseEstimate: "/pose"}


def topic_named(name: str) -> Topic | None:
    """The topic that a channel's name belongs to, its suffix set aside; None for a stranger."""
    stem = next((t for t in RECORD + TRUTH if t.name == name), None)
    return stem or next((t for t in RECORD + TRUTH if name.startswith(t.name + "/")), None)
