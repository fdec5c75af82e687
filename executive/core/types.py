"""The values that flow: immutable, SI units, frames in their names.

Quaternions are (x, y, z, w). A quaternion `quat_a_b` rotates vectors from frame b into frame a.
Rotation errors are small rotation vectors in `site` axes: R_true = exp(d_theta) R_estimate.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Vec2 = tuple[float, float]
Vec3 = tuple[float, float, float]
Quat = tuple[float, float, float, float]

T = TypeVar("T")
T_co = TypeVar("T_co", covariant=True)


class Reason(StrEnum):
    """Why something ended, in physical terms; recovery is chosen by it."""

    DONE = "done"
    CANCELLED = "cancelled"
    TIMEOUT = "timeout"
    BLOCKED = "blocked"
    OFF_TRACK = "off_track"
    OFF_HEADING = "off_heading"
    OVERSHOOT = "overshoot"
    UNEXPECTED = "unexpected"
    NOT_SEEN = "not_seen"
    POOR_VIEW = "poor_view"
    UNSTABLE_IMAGES = "unstable_images"
    IMPLAUSIBLE = "implausible"
    MISALIGNED = "misaligned"
    OUT_OF_REACH = "out_of_reach"
    ARRIVAL_UNCERTAIN = "arrival_uncertain"
    TILT = "tilt"
    TETHER = "tether"
    DEVICE = "device"
    NO_STRATEGY = "no_strategy"
    GUARD = "guard"
    UNSET = "unset"


@dataclass(frozen=True)
class Outcome(Generic[T_co]):
    """How an action ended. `value` is what was actually done or measured, also on failure if known."""

    reason: Reason
    detail: str = ""
    value: T_co | None = None

    @property
    def ok(self) -> bool:
        return self.reason is Reason.DONE


class Quality(StrEnum):
    """What is asked of a localisation."""

    TREND = "trend"  # motion fragments, while moving: coarse and cheap
    PRECISE = "precise"  # active markers, at rest
    FAR = "far"  # long averaging, at rest


class PoseSource(StrEnum):
    """Where a pose estimate comes from that is no fix; a fix bears a name of its localizer's own."""

    PRIOR = "prior"
    PREDICTION = "prediction"
    TREND = "trend"


def frozen_array(values: object, shape: tuple[int, ...]) -> Array:
    """A read-only float64 copy of `values`; ValueError if its shape is not `shape`."""
    array = np.array(values, dtype=np.float64)
    if array.shape != shape:
        raise ValueError(f"got an array of shape {array.shape}, expected {shape}")
    array.setflags(write=False)
    return array


@dataclass(frozen=True)
class Point:
    """A point of the plan, in `site`, horizontal [m]."""

    x_m: float
    y_m: float


@dataclass(frozen=True)
class Segment:
    """A straight path segment between two way-points, with its margins (paper, section 3.1).

    `tolerance_m` is of its end, `start_tolerance_m` of its start (None: the same). What lies no farther from
    it than `off_track_m` is its corridor: `executive.core.corridor`.
    """

    start: Point
    end: Point
    on_track_m: float
    off_track_m: float
    tolerance_m: float
    index: int = 0
    start_tolerance_m: float | None = None

    @property
    def length_m(self) -> float:
        return math.hypot(self.end.x_m - self.start.x_m, self.end.y_m - self.start.y_m)

    @property
    def bearing_rad(self) -> float:
        return math.atan2(self.end.y_m - self.start.y_m, self.end.x_m - self.start.x_m)

    def offset(self, x_m: float, y_m: float) -> TrackOffset:
        """Where (x, y) lies relative to this segment. Beyond its ends the line is extended."""
        dx, dy = x_m - self.start.x_m, y_m - self.start.y_m
        c, s = math.cos(self.bearing_rad), math.sin(self.bearing_rad)
        to_end = (self.end.x_m - x_m, self.end.y_m - y_m)
        return TrackOffset(
            along_m=c * dx + s * dy,
            cross_m=-s * dx + c * dy,
            remaining_m=math.hypot(*to_end),
            bearing_to_end_rad=math.atan2(to_end[1], to_end[0]),
        )


@dataclass(frozen=True)
class TrackOffset:
    """A position relative to a segment: along it, left of it (positive), and what remains."""

    along_m: float
    cross_m: float
    remaining_m: float
    bearing_to_end_rad: float


@dataclass(frozen=True, eq=False)
class PoseEstimate:
    """Pose of `body` in `site` at `time_s`, with its 6x6 covariance (position m, rotation rad).

    `source` is a `PoseSource`, or the name that a localizer gives to its fixes. `track` is the offset from
    the segment under way, None where there is none. `markers` counts the markers that a fix rests on.
    """

    time_s: float
    position_site_m: Vec3
    quat_site_body: Quat
    covariance: Array
    source: str
    track: TrackOffset | None = None
    markers: int = 0

    def __post_init__(self) -> None:
        object.__setattr__(self, "covariance", frozen_array(self.covariance, (6, 6)))

    @property
    def is_fix(self) -> bool:
        """Whether a localizer measured it, with the rover at rest."""
        return self.source not in tuple(PoseSource)

    @property
    def x_m(self) -> float:
        return self.position_site_m[0]

    @property
    def y_m(self) -> float:
        return self.position_site_m[1]

    @property
    def point(self) -> Point:
        return Point(self.x_m, self.y_m)

    @property
    def heading_rad(self) -> float:
        """Direction of the body's x axis projected on the horizontal, from site x, left positive."""
        x, y, z, w = self.quat_site_body
        return math.atan2(2 * (x * y + w * z), 1 - 2 * (y * y + z * z))

    @property
    def tilt_rad(self) -> float:
        """Angle between the body's z axis and the vertical, 0 or more."""
        x, y, _, _ = self.quat_site_body
        return math.acos(max(-1.0, min(1.0, 1 - 2 * (x * x + y * y))))

    @property
    def sigma_position_m(self) -> float:
        """Largest horizontal standard deviation [m]."""
        return float(math.sqrt(max(np.linalg.eigvalsh(self.covariance[:2, :2])[-1], 0.0)))

    def sigma_across_m(self, segment: Segment) -> float:
        """Standard deviation across the segment's line [m]."""
        c, s = math.cos(segment.bearing_rad), math.sin(segment.bearing_rad)
        across = np.array([-s, c])
        return float(math.sqrt(max(across @ self.covariance[:2, :2] @ across, 0.0)))

    @property
    def sigma_heading_rad(self) -> float:
        return float(math.sqrt(max(self.covariance[5, 5], 0.0)))

    def on(self, segment: Segment | None) -> PoseEstimate:
        """The same pose, with its offset from `segment` filled in."""
        offset = None if segment is None else segment.offset(self.x_m, self.y_m)
        return replace(self, track=offset)


@dataclass(frozen=True)
class TrackReading:
    """Tracks' telemetry: belt travel since power-up [m], motor currents [A]."""

    time_s: float
    left_m: float
    right_m: float
    left_current_a: float
    right_current_a: float
    moving: bool


@dataclass(frozen=True)
class CabinReading:
    """Angles of the arm and cabin joints [rad]; both 0 when the cabin lies flat and low."""

    time_s: float
    arm_rad: float
    cabin_rad: float
    moving: bool


@dataclass(frozen=True)
class HeadReading:
    """Pan (left positive) and tilt (down positive) of the imaging head, as its encoders say [rad]."""

    time_s: float
    pan_rad: float
    tilt_rad: float
    moving: bool


@dataclass(frozen=True)
class TiltReading:
    """Inclinometers: rotation of the body about its x (roll) and y (pitch) axes [rad]."""

    time_s: float
    roll_rad: float
    pitch_rad: float


@dataclass(frozen=True)
class TetherReading:
    """Paid-out length [m] and tension at the spool [N]."""

    time_s: float
    length_m: float
    tension_n: float


@dataclass(frozen=True)
class Window:
    """A rectangle of pixels to read out: columns from `u`, rows from `v`, `width` x `height`."""

    u: int
    v: int
    width: int
    height: int


LEFT, RIGHT = 0, 1


@dataclass(frozen=True)
class Shot:
    """A sequence of stereo exposures: per frame the LEDs lit (bit i = marker i), then both windows.

    `windows` None reads both full frames. `cadence_s` is the time from one frame to the next, `exposure` the
    time for which a frame gathers light, of that to which the cameras were set for sunlit ground.
    """

    leds: tuple[int, ...]
    windows: tuple[Window, Window] | None = None
    cadence_s: float = 0.5
    exposure: float = 1.0


@dataclass(frozen=True, eq=False)
class Images:
    """What the cameras return: per camera a uint16 stack, shape (frames, height, width), in counts."""

    time_s: float
    shot: Shot
    windows: tuple[Window, Window]
    counts: tuple[NDArray[np.uint16], NDArray[np.uint16]]
    head: HeadReading


@dataclass(frozen=True, eq=False)
class Landmarks:
    """Bits of ground that one camera can tell apart, geometric tier only.

    `names` (n,) tell which is which in another picture and say nothing else; `uv_px` (n, 2) is where they
    show, in full-frame pixels.
    """

    names: NDArray[np.int64]
    uv_px: Array


@dataclass(frozen=True, eq=False)
class Centres:
    """What the geometric tier returns in place of images: marker centres in full-frame pixels.

    Shapes: `uv_px` (2 cameras, 4 markers, 2), NaN where not detected; `sigma_px` (2, 4). `ground` is what a
    picture (one frame, no LED lit) shows of the landscape, left and right; None for any other shot. Three and
    more frames without an LED are for outlines: `uv_px` is then where the rover's outline puts the markers.
    `saturated` says of each camera whether there was too much light to see anything.
    """

    time_s: float
    shot: Shot
    uv_px: Array
    sigma_px: Array
    head: HeadReading
    ground: tuple[Landmarks, Landmarks] | None = None
    saturated: tuple[bool, bool] = (False, False)


@dataclass(frozen=True, eq=False)
class CameraView:
    """What one camera showed at a localisation, for people: a patch of the frame and what was found in it.

    `counts` has shape (height, width) and is the part `window` of the full frame. Centres are in pixels of
    the full frame, one row per marker, shape (n, 2), NaN where there is none.
    """

    window: Window
    counts: NDArray[np.float32]
    detected_px: Array
    reprojected_px: Array


@dataclass(frozen=True, eq=False)
class Localisation:
    """What a localisation found and what it looked at: the pose, None where there is none to tell of, and a
    view of each camera, left and right; no views where there are no images."""

    pose: PoseEstimate | None
    views: tuple[CameraView, ...] = ()


@dataclass(frozen=True)
class Call:
    """A call to ground: why, and the evidence attached."""

    time_s: float
    reason: Reason
    detail: str
    evidence: dict[str, float] = field(default_factory=dict)
