"""Ground truth as arrays over mission time, and the measures that join it with the record."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from executive.core.corridor import distances_m
from executive.core.types import Array, PoseEstimate, Segment
from executive.record.events import SegmentEvent, TruthEvent
from executive.record.history import At, History

if TYPE_CHECKING:  # half a second that only those who ask for an attitude should wait
    from scipy.spatial.transform import Rotation


@dataclass(frozen=True, eq=False)
class Track:
    """The true track: `time_s` (n,), `position_site_m` (n, 3), `quat_site_body` (n, 4), tether force (n,)."""

    time_s: Array
    position_site_m: Array
    quat_site_body: Array
    tether_n: Array

    @classmethod
    def of(cls, truth: History) -> Track | None:
        """The track, or None where the truth holds no pose."""
        samples = truth.all(TruthEvent)
        if not samples:
            return None
        times = np.array([at.time_s for at in samples])
        keep = np.concatenate([np.diff(times) > 0, [True]])  # of samples at one time the last counts
        return cls(
            times[keep],
            np.array([at.event.position_site_m for at in samples])[keep],
            np.array([at.event.quat_site_body for at in samples])[keep],
            np.array([at.event.tether_n for at in samples])[keep],
        )

    def position(self, time_s: float) -> Array:
        """True position [m] at a time: exact at a sample, linear between two, held beyond the ends."""
        return np.array([np.interp(time_s, self.time_s, axis) for axis in self.position_site_m.T])

    def rotation(self, time_s: float) -> Rotation:
        """True attitude, body to site, at a time: exact at a sample, turned evenly between two."""
        from scipy.spatial.transform import Rotation, Slerp

        i = int(np.searchsorted(self.time_s, time_s))
        if i == len(self.time_s):
            return Rotation.from_quat(self.quat_site_body[-1])
        if i == 0 or self.time_s[i] == time_s:
            return Rotation.from_quat(self.quat_site_body[i])
        pair = Rotation.from_quat(self.quat_site_body[i - 1 : i + 1])
        return Slerp(self.time_s[i - 1 : i + 1], pair)(time_s)

    def steps_m(self) -> Array:
        """Horizontal way from each sample to the next [m], shape (n - 1,)."""
        return np.asarray(np.hypot(*np.diff(self.position_site_m[:, :2], axis=0).T), dtype=np.float64)

    def tilt_rad(self) -> Array:
        """Angle between the body's z axis and the vertical, shape (n,)."""
        x, y = self.quat_site_body[:, 0], self.quat_site_body[:, 1]
        return np.asarray(np.arccos(np.clip(1 - 2 * (x * x + y * y), -1, 1)))


@dataclass(frozen=True, eq=False)
class CrossTrack:
    """True cross-track error, and distance from the segment: NaN where there was none. All shapes (n,)."""

    time_s: Array
    cross_m: Array
    distance_m: Array
    on_track_m: Array
    off_track_m: Array


def cross_track(track: Track, segments: list[At[SegmentEvent]]) -> CrossTrack:
    """The true offset of each sample from the segment under way at its time (left positive)."""
    under_way = np.searchsorted([at.time_s for at in segments], track.time_s, side="right") - 1
    columns = np.full((4, len(track.time_s)), np.nan)
    for number, at in enumerate(segments):
        if at.event.segment is not None:
            mine = under_way == number
            columns[:, mine] = _columns(at.event.segment, track.position_site_m[mine])
    return CrossTrack(track.time_s, *columns)


def _columns(segment: Segment, position_m: Array) -> Array:
    """Cross-track error, distance and both margins, shape (4, n)."""
    cosine, sine = np.cos(segment.bearing_rad), np.sin(segment.bearing_rad)
    dx, dy = position_m[:, 0] - segment.start.x_m, position_m[:, 1] - segment.start.y_m
    ones = np.ones(len(dx))
    away = distances_m(segment, position_m[:, 0], position_m[:, 1])
    return np.array([-sine * dx + cosine * dy, away, segment.on_track_m * ones, segment.off_track_m * ones])


def driven_beyond_m(track: Track, cross: CrossTrack) -> Array:
    """True way driven so far farther from the segment than its off-track margin [m], shape (n,).

    A step counts by where it ends; one that starts or ends without a segment does not count.
    """
    beyond: NDArray[np.bool_] = cross.distance_m > cross.off_track_m  # False where NaN
    counted = beyond[1:] & np.isfinite(cross.cross_m[:-1])
    return np.concatenate([[0.0], np.cumsum(np.where(counted, track.steps_m(), 0.0))])


@dataclass(frozen=True, eq=False)
class PoseError:
    """Truth minus estimate at the estimate's time, in `site`: position [m] and rotation vector [rad]."""

    time_s: float
    position_m: Array
    rotation_rad: Array
    nees: float

    @classmethod
    def of(cls, track: Track, pose: PoseEstimate) -> PoseError:
        """R_true = exp(rotation) R_estimate; NEES over all six components, expected 6 if consistent."""
        from scipy.spatial.transform import Rotation

        position = track.position(pose.time_s) - np.array(pose.position_site_m)
        rotation = track.rotation(pose.time_s) * Rotation.from_quat(pose.quat_site_body).inv()
        error = np.concatenate([position, rotation.as_rotvec()])
        return cls(pose.time_s, position, error[3:], _nees(error, pose.covariance))


def _nees(error: Array, covariance: Array) -> float:
    """The squared error in units of its covariance; NaN for a covariance that cannot be inverted."""
    try:
        return float(error @ np.linalg.solve(covariance, error))
    except np.linalg.LinAlgError:
        return float("nan")
