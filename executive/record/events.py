"""What a record holds beside `PoseEstimate` and `Call`: one frozen dataclass per topic.

Allowed field types are those of `executive.record.schema`: the protobuf schemas are made from these
classes, so a field added here is in the file, readable by any MCAP viewer, without further work.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from executive.core.types import (
    Point,
    PoseEstimate,
    Quat,
    Segment,
    Vec2,
    Vec3,
)


@dataclass(frozen=True)
class Start:
    """The first document: all that is needed to repeat the run. `versions` maps package to version."""

    scenario: str
    scenario_yaml: str
    seed: int
    tick_s: float
    tier: str = "full"
    versions: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Stop:
    """The last document: how the run ended. `outcome` is one of `result.json`'s outcomes."""

    outcome: str
    reason: str | None = None
    detail: str = ""


@dataclass(frozen=True)
class Resumed:
    """A run that was cut off goes on here, for the `number`th time; it looks before it drives."""

    number: int


@dataclass(frozen=True)
class NodeChange:
    """A node's status changed. `reason` and `detail` say why a leaf or a guard ended it, empty otherwise."""

    path: str
    status: str
    reason: str = ""
    detail: str = ""


@dataclass(frozen=True)
class Command:
    """What a device was told: its name, the verb, and the values in SI units."""

    device: str
    verb: str
    values: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class HypothesesEvent:
    """Weights of the fault hypotheses, summing to 1, and what the likeliest leads to.

    `time_to_margin_s` is when, going on as then, the off-track margin is crossed [s]; None for never, and
    where no segment was under way.
    """

    weights: dict[str, float]
    time_to_margin_s: float | None = None


class Verdict(StrEnum):
    """What became of a strategy."""

    CHOSEN = "chosen"
    HELPED = "helped"
    FAILED = "failed"


@dataclass(frozen=True)
class StrategyEvent:
    """A strategy was chosen, or its effect was verified. `why` is a sentence for people."""

    name: str
    hypothesis: str
    weight: float
    attempt: int
    verdict: Verdict
    why: str = ""


@dataclass(frozen=True)
class Telemetry:
    """One sample of everything the rover and head report. SI units; angles in rad."""

    left_m: float
    right_m: float
    left_current_a: float
    right_current_a: float
    roll_rad: float
    pitch_rad: float
    arm_rad: float
    cabin_rad: float
    pan_rad: float
    tilt_rad: float
    tether_m: float
    tether_n: float
    moving: bool = False


@dataclass(frozen=True)
class DeviceReading:
    """One sample of what a device reports, by quantity, in SI units."""

    device: str
    values: dict[str, float]


@dataclass(frozen=True)
class RouteEvent:
    """The whole plan as uplinked, in order."""

    segments: tuple[Segment, ...]


@dataclass(frozen=True)
class SegmentEvent:
    """The segment under way from now on; None between segments."""

    segment: Segment | None


@dataclass(frozen=True)
class WaypointEvent:
    """The executive declared a way-point reached: which, where it lies in `site`, and its belief."""

    index: int
    target: Point
    pose: PoseEstimate


@dataclass(frozen=True)
class Rock:
    """A rock on the map known to ground, as a circle in `site` [m]."""

    x_m: float
    y_m: float
    radius_m: float


@dataclass(frozen=True, eq=False)
class TerrainEvent:
    """The coarse elevation map as ground knows it, in `site`.

    `elevation_m` has shape (rows, columns): row i at y = origin_m[1] + i * step_m, column j likewise in x.
    """

    origin_m: Vec2
    step_m: float
    elevation_m: NDArray[np.float32]
    rocks: tuple[Rock, ...] = ()


@dataclass(frozen=True)
class FaultArmedEvent:
    """The onset of an injected fault has come; it acts from now on wherever it can. `cause` if it has one."""

    name: str
    cause: str = ""


@dataclass(frozen=True)
class FaultEvent:
    """An injected fault took effect (`active`) or ceased. `hypothesis` is the diagnosis it should lead to."""

    name: str
    active: bool
    hypothesis: str = ""


@dataclass(frozen=True)
class Placed:
    """Something that lies in the world, as a circle in `site` [m]; `kind` is such as `rock` or `soil`."""

    kind: str
    x_m: float
    y_m: float
    radius_m: float


@dataclass(frozen=True)
class PlacedEvent:
    """What an injected fault has lying in the world from now on; nothing once it has taken it away again."""

    name: str
    things: tuple[Placed, ...]


@dataclass(frozen=True)
class ImageEvent:
    """A small picture of what camera `left` or `right` saw; `format` is png or jpeg."""

    camera: str
    format: str
    data: bytes


@dataclass(frozen=True)
class Box:
    """A read-out window in pixels of the recorded picture."""

    u: float
    v: float
    width: float
    height: float


@dataclass(frozen=True)
class Spot:
    """A marker in pixels of the recorded picture."""

    marker: int
    u: float
    v: float


@dataclass(frozen=True)
class AnnotationsEvent:
    """What the localisation found in the picture of the same camera and time."""

    camera: str
    caption: str = ""
    windows: tuple[Box, ...] = ()
    detected: tuple[Spot, ...] = ()
    reprojected: tuple[Spot, ...] = ()


class Level(StrEnum):
    DEBUG = "debug"
    INFO = "info"
    WARNING = "warning"
    ERROR = "error"


@dataclass(frozen=True)
class LogEvent:
    """A sentence for people; `name` is the part that says it."""

    level: Level
    name: str
    message: str


@dataclass(frozen=True)
class TruthEvent:
    """The simulator's own truth, in truth.mcap only: never an input to the executive.

    Pose of `body` in `site`; head angles as they really are; slip per track, 0 for none and 1 for spinning
    in place; joints, tether.
    """

    position_site_m: Vec3
    quat_site_body: Quat
    pan_rad: float = 0.0
    tilt_rad: float = 0.0
    arm_rad: float = 0.0
    cabin_rad: float = 0.0
    slip_left: float = 0.0
    slip_right: float = 0.0
    tether_m: float = 0.0
    tether_n: float = 0.0
