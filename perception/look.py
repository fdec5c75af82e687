"""From what the cameras returned to marker candidates: images and geometric centres meet here."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from executive.rig import RigCalibration
from executive.types import Array, Centres, Images
from perception.difference import difference
from perception.frames import check_frames, saturation
from perception.markers import Detection, find_markers
from perception.psf import marker_spread
from perception.similarity import compare

FALSE_ALARM_RATE = 0.2  # per window and LED; high, as the joint check comes after


@dataclass(frozen=True, eq=False)
class Look:
    """Candidates [camera][marker], the dark images, and what makes the frames unusable (or empty)."""

    candidates: Sequence[Sequence[Sequence[Detection]]]
    reference: tuple[NDArray[np.float32], NDArray[np.float32]] | None
    problem: str = ""

    @property
    def strongest_px(self) -> Array:
        """Centres (2, n, 2) of the strongest candidates, NaN where none."""
        uv = np.full((2, len(self.candidates[0]), 2), np.nan)
        for camera, per_marker in enumerate(self.candidates):
            for marker, found in enumerate(per_marker):
                if found:
                    uv[camera, marker] = found[0].uv_px
        return uv


def look_at(rig: RigCalibration, data: Images | Centres, range_m: float) -> Look:
    """Marker candidates in what the cameras returned, markers expected at about `range_m`.

    ValueError unless the frames are as ordered (perception.frames).
    """
    if isinstance(data, Centres):
        return Look(_given(data), None)
    check_frames(data, rig.sensor)
    cameras = [_detect(rig, data, camera, range_m) for camera in (0, 1)]
    problems = [f"{name} camera: {c[2]}" for name, c in zip(("left", "right"), cameras, strict=True) if c[2]]
    return Look([c[0] for c in cameras], (cameras[0][1], cameras[1][1]), "; ".join(problems))


def _detect(
    rig: RigCalibration, images: Images, camera: int, range_m: float
) -> tuple[list[list[Detection]], NDArray[np.float32], str]:
    """One camera's candidates by marker, dark image, and problem."""
    window, leds = images.windows[camera], images.shot.leds
    markers = len(rig.markers.positions_plc_m)
    similarity = compare(images.counts[camera], rig.sensor.noise_counts)
    found = difference(similarity.frames, leds, markers, rig.sensor.noise_counts)
    spread = marker_spread(rig, range_m)
    candidates = [
        find_markers(image, sigma, spread, (window.u, window.v), FALSE_ALARM_RATE) if 1 << m in leds else []
        for m, (image, sigma) in enumerate(zip(found.images, found.sigma, strict=True))
    ]
    problem = saturation(images.counts[camera], rig.sensor) or similarity.problem
    return candidates, found.reference, problem


def _given(centres: Centres) -> list[list[list[Detection]]]:
    """The geometric tier's centres as candidates; their brightness is not known, taken for equal."""
    return [
        [
            [Detection(uv, sigma**2 * np.eye(2), 1.0, 0.1)] if np.isfinite(uv).all() and sigma > 0 else []
            for uv, sigma in zip(centres.uv_px[camera], centres.sigma_px[camera], strict=True)
        ]
        for camera in (0, 1)
    ]
