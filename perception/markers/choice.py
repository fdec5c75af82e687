"""What a plausibility check starts from and ends with: candidates, an accepted choice, a rejection."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from executive.core.types import Array, Vec2
from perception.geometry.chain import Chain
from perception.geometry.pose import Fix, Prior, Sighting
from perception.markers.centres import Detection

Candidates = Sequence[Sequence[Sequence[Detection]]]  # [camera][marker] -> detections; [] for a blind camera


Answer = TypeVar("Answer", bound="Choice | JointFix | Rejection")


@dataclass(frozen=True, eq=False)
class Choice:
    """The accepted set and its pose; `sets_tried` says how much it took, `note` what is odd about it."""

    fix: Fix
    sighting: Sighting
    sets_tried: int
    note: str = ""

    @property
    def shining(self) -> tuple[int, ...]:
        """The markers that entered the pose."""
        seen = np.isfinite(self.sighting.uv_px).all(axis=-1).any(axis=0)
        return tuple(np.flatnonzero(seen).tolist())

    @property
    def markers(self) -> int:
        return len(self.shining)

    @property
    def detected_px(self) -> Array:
        """Centres (2, n, 2) that entered the pose, NaN where none."""
        return self.sighting.uv_px


@dataclass(frozen=True, eq=False)
class JointFix:
    """An accepted pose, the markers that shine in it, and `note`: what stood out from what.

    `detected_px` (2, n, 2) is where the images alone pull each centre.
    """

    fix: Fix
    markers: int
    detected_px: Array
    note: str


@dataclass(frozen=True)
class Rejection:
    """Why no set was accepted. `seen` counts LEDs with a candidate in every camera that sees."""

    why: str
    seen: int


def noted(answer: Answer, note: str) -> Answer:
    """The answer with a note put before what it says, if there is one."""
    if not note:
        return answer
    if isinstance(answer, Rejection):
        return replace(answer, why=f"{note}; {answer.why}")
    return replace(answer, note="; ".join(filter(None, (note, answer.note))))


@dataclass(frozen=True, eq=False)
class Circumstances:
    """What is read besides images: encoders of head and cabin joints, inclinometers, the prediction."""

    chain: Chain
    head_rad: Vec2
    joints_rad: Vec2
    tilt_rad: Vec2 | None
    prior: Prior | None

    @property
    def markers(self) -> int:
        return len(self.chain.markers_plc_m)

    def sighting(self, detections: Iterable[tuple[int, int, Detection]]) -> Sighting:
        """The measurement that detections (camera, marker, detection) stand for."""
        uv, covariance = np.full((2, self.markers, 2), np.nan), np.full((2, self.markers, 2, 2), np.nan)
        for camera, marker, detection in detections:
            uv[camera, marker], covariance[camera, marker] = detection.uv_px, detection.covariance_px2
        return Sighting(uv, covariance, self.head_rad, self.joints_rad, self.tilt_rad)


def brightness_misfit(flux_counts: Sequence[float]) -> float:
    """Spread of the markers' brightness in squared factors of two: they share plane, range and power."""
    flux = np.array(flux_counts)
    return float(np.square(np.log2(flux / np.median(flux))).sum())


def faces_cameras(chain: Chain, fix: Fix) -> bool:
    """Whether the marker plane shows its lit side to the head: a mirrored assignment shows its back."""
    plc = chain.site_plc(fix.state)
    mast = np.array([0.0, 0.0, chain.rig.head.mast_height_m])
    return bool(plc.rotation[:, 2] @ (mast - plc.position_m) > 0)
