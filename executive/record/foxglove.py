"""Events that have a Foxglove schema of their own, so that its viewers draw them without a plug-in.

`stamp_ns` is mission time [ns]; the Foxglove messages repeat it in their `timestamp`.
"""

from __future__ import annotations

from collections.abc import Iterable

from foxglove_schemas_protobuf.CircleAnnotation_pb2 import CircleAnnotation
from foxglove_schemas_protobuf.Color_pb2 import Color
from foxglove_schemas_protobuf.CompressedImage_pb2 import CompressedImage
from foxglove_schemas_protobuf.ImageAnnotations_pb2 import ImageAnnotations
from foxglove_schemas_protobuf.KeyValuePair_pb2 import KeyValuePair
from foxglove_schemas_protobuf.Log_pb2 import Log
from foxglove_schemas_protobuf.Point2_pb2 import Point2
from foxglove_schemas_protobuf.PointsAnnotation_pb2 import PointsAnnotation
from foxglove_schemas_protobuf.Pose_pb2 import Pose
from foxglove_schemas_protobuf.PoseInFrame_pb2 import PoseInFrame
from foxglove_schemas_protobuf.Quaternion_pb2 import Quaternion
from foxglove_schemas_protobuf.Vector3_pb2 import Vector3
from google.protobuf.timestamp_pb2 import Timestamp

from executive.core.types import PoseEstimate
from executive.record.events import (
    AnnotationsEvent,
    Box,
    ImageEvent,
    Level,
    LogEvent,
    Spot,
)

_LEVELS = {
    Level.DEBUG: Log.DEBUG,
    Level.INFO: Log.INFO,
    Level.WARNING: Log.WARNING,
    Level.ERROR: Log.ERROR,
}
_LEVEL_OF = {number: level for level, number in _LEVELS.items()}
_DETECTED, _REPROJECTED = "detected", "reprojected"
_COLOURS = {_DETECTED: (1.0, 0.62, 0.1), _REPROJECTED: (0.1, 0.75, 1.0)}


def _stamp(stamp_ns: int) -> Timestamp:
    return Timestamp(seconds=stamp_ns // 1_000_000_000, nanos=stamp_ns % 1_000_000_000)


def _kind(name: str, marker: int) -> list[KeyValuePair]:
    return [KeyValuePair(key="kind", value=name), KeyValuePair(key="marker", value=str(marker))]


def _camera_of(frame_id: str) -> str:
    return frame_id.removeprefix("cam_")


def pose_in_frame(pose: PoseEstimate, stamp_ns: int) -> PoseInFrame:
    """The estimate's pose of `body`, for 3D views."""
    (x, y, z), (qx, qy, qz, qw) = pose.position_site_m, pose.quat_site_body
    placed = Pose(position=Vector3(x=x, y=y, z=z), orientation=Quaternion(x=qx, y=qy, z=qz, w=qw))
    return PoseInFrame(timestamp=_stamp(stamp_ns), frame_id="site", pose=placed)


def image_message(event: ImageEvent, stamp_ns: int) -> CompressedImage:
    return CompressedImage(
        timestamp=_stamp(stamp_ns), frame_id=f"cam_{event.camera}", data=event.data, format=event.format
    )


def image_event(message: CompressedImage) -> ImageEvent:
    return ImageEvent(_camera_of(message.frame_id), message.format, message.data)


def log_message(event: LogEvent, stamp_ns: int) -> Log:
    return Log(timestamp=_stamp(stamp_ns), level=_LEVELS[event.level], name=event.name, message=event.message)


def log_event(message: Log) -> LogEvent:
    return LogEvent(_LEVEL_OF.get(message.level, Level.INFO), message.name, message.message)


def annotations_message(event: AnnotationsEvent, stamp_ns: int) -> ImageAnnotations:
    """Windows as loops, markers as circles; the caption and the camera as metadata."""
    return ImageAnnotations(
        timestamp=_stamp(stamp_ns),
        circles=[*_circles(event.detected, _DETECTED), *_circles(event.reprojected, _REPROJECTED)],
        points=[_loop(box) for box in event.windows],
        metadata=[
            KeyValuePair(key="camera", value=event.camera),
            KeyValuePair(key="caption", value=event.caption),
        ],
    )


def annotations_event(message: ImageAnnotations) -> AnnotationsEvent:
    said = {pair.key: pair.value for pair in message.metadata}
    return AnnotationsEvent(
        camera=said.get("camera", ""),
        caption=said.get("caption", ""),
        windows=tuple(_box(loop) for loop in message.points),
        detected=_spots(message.circles, _DETECTED),
        reprojected=_spots(message.circles, _REPROJECTED),
    )


def _circles(spots: Iterable[Spot], kind: str) -> list[CircleAnnotation]:
    red, green, blue = _COLOURS[kind]
    return [
        CircleAnnotation(
            position=Point2(x=spot.u, y=spot.v),
            diameter=8.0 if kind == _DETECTED else 4.0,
            thickness=1.0,
            outline_color=Color(r=red, g=green, b=blue, a=1.0),
            metadata=_kind(kind, spot.marker),
        )
        for spot in spots
    ]


def _spots(circles: Iterable[CircleAnnotation], kind: str) -> tuple[Spot, ...]:
    found = []
    for circle in circles:
        said = {pair.key: pair.value for pair in circle.metadata}
        if said.get("kind") == kind:
            found.append(Spot(int(said.get("marker", "-1")), circle.position.x, circle.position.y))
    return tuple(found)


def _loop(box: Box) -> PointsAnnotation:
    right, bottom = box.u + box.width, box.v + box.height
    corners = [(box.u, box.v), (right, box.v), (right, bottom), (box.u, bottom)]
    return PointsAnnotation(
        type=PointsAnnotation.LINE_LOOP,
        points=[Point2(x=u, y=v) for u, v in corners],
        outline_color=Color(r=0.3, g=0.9, b=0.5, a=1.0),
        thickness=1.0,
        metadata=[
            KeyValuePair(key="width", value=repr(box.width)),
            KeyValuePair(key="height", value=repr(box.height)),
        ],
    )


def _box(loop: PointsAnnotation) -> Box:
    said = {pair.key: pair.value for pair in loop.metadata}
    return Box(loop.points[0].x, loop.points[0].y, float(said["width"]), float(said["height"]))
