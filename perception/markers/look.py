"""From what the cameras returned to marker candidates: images and geometric centres meet here."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from executive.core.rig import RigCalibration
from executive.core.types import Array, Centres, Images
from perception.frames.difference import difference
from perception.frames.psf import marker_spread
from perception.frames.shots import (
    blackness,
    check_frames,
    fresh,
    saturation,
    staleness,
    stuck_pixels,
)
from perception.frames.similarity import compare
from perception.markers.centres import Detection, find_markers
from perception.markers.choice import Candidates

FALSE_ALARM_RATE = 0.2  # per window and LED; high, as the joint check comes after


_NAMES = ("left", "right")


@dataclass(frozen=True, eq=False)
class Look:
    """Candidates [camera][marker], the dark images, and what makes the frames unusable (or empty).

    A camera that shows nothing usable has no candidates at all, `[]`, and `note` says why; if neither does,
    that is the `problem`. `unknown_px` is for `frames.vibration.shaken`: how little is known of where the
    head pointed while it trembled.
    """

    candidates: Candidates
    reference: tuple[NDArray[np.float32], NDArray[np.float32]] | None
    problem: str = ""
    note: str = ""
    unknown_px: tuple[float, ...] = ()

    @property
    def strongest_px(self) -> Array:
        """Centres (2, n, 2) of the strongest candidates, NaN where none."""
        uv = np.full((2, max(len(camera) for camera in self.candidates), 2), np.nan)
        for camera, per_marker in enumerate(self.candidates):
            for marker, found in enumerate(per_marker):
                if found:
                    uv[camera, marker] = found[0].uv_px
        return uv


def look_at(rig: RigCalibration, data: Images | Centres, range_m: float) -> Look:
    """Marker candidates in what the cameras returned, markers expected at about `range_m`.

    ValueError unless the frames are as ordered (perception.frames.shots).
    """
    if isinstance(data, Centres):
        return Look(_given(data), None)
    check_frames(data, rig.sensor)
    cameras = [_detect(rig, data, camera, range_m) for camera in (0, 1)]
    black = blackness((float(np.median(cameras[0].reference)), float(np.median(cameras[1].reference))))
    problems = [dark or camera.problem for dark, camera in zip(black, cameras, strict=True)]
    said = "; ".join(f"{name} camera: {why}" for name, why in zip(_NAMES, problems, strict=True) if why)
    blind = all(problems)
    candidates = [
        [] if why and not blind else camera.candidates for camera, why in zip(cameras, problems, strict=True)
    ]
    reference = cameras[0].reference, cameras[1].reference
    unknown = tuple(camera.unknown_px for camera in cameras)
    return Look(candidates, reference, said if blind else "", "" if blind else said, unknown)


@dataclass(frozen=True, eq=False)
class _Seen:
    """One camera's candidates by marker, dark image, problem, and how little the pointing is known [px]."""

    candidates: list[list[Detection]]
    reference: NDArray[np.float32]
    problem: str
    unknown_px: float = 0.0


def _detect(rig: RigCalibration, images: Images, camera: int, range_m: float) -> _Seen:
    """What one camera shows."""
    window, markers = images.windows[camera], len(rig.markers.positions_plc_m)
    counts, leds, sensor = images.counts[camera], images.shot.leds, rig.sensor
    nothing: list[list[Detection]] = [[] for _ in range(markers)]
    kept = fresh(counts)
    stale = staleness(kept)
    if not kept.all() and not stale:
        counts, leds = counts[kept], tuple(mask for mask, keep in zip(leds, kept, strict=True) if keep)
        stale = "" if 0 in leds else "no frame with dark LEDs is left"
    if stale:
        return _Seen(nothing, images.counts[camera].mean(axis=0, dtype=np.float32), stale)
    similarity = compare(counts, sensor.noise_counts)
    found = difference(similarity.frames, leds, markers, sensor.noise_counts)
    found = found.without(stuck_pixels(counts, sensor))
    spread = marker_spread(rig, range_m)
    candidates = [
        find_markers(image, sigma, spread, (window.u, window.v), FALSE_ALARM_RATE) if 1 << m in leds else []
        for m, (image, sigma) in enumerate(zip(found.images, found.sigma, strict=True))
    ]
    problem = saturation(counts, sensor) or similarity.problem
    return _Seen(candidates, found.reference, problem, similarity.unknown_px)


def _given(centres: Centres) -> list[list[list[Detection]]]:
    """The geometric tier's centres as candidates; their brightness is not known, taken for equal."""
    return [
        [
            [Detection(uv, sigma**2 * np.eye(2), 1.0, 0.1)] if np.isfinite(uv).all() and sigma > 0 else []
            for uv, sigma in zip(centres.uv_px[camera], centres.sigma_px[camera], strict=True)
        ]
        for camera in (0, 1)
    ]
