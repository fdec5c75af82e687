"""Each marker seen by itself: from what the cameras returned to candidates, and to the fix that they give."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from executive.core.rig import RigCalibration
from executive.core.types import Array, Centres, Images, Vec2
from perception.frames.difference import difference
from perception.frames.exposure import plate_view
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
from perception.frames.vibration import shaken
from perception.frames.views import Pictures
from perception.geometry.chain import Chain
from perception.geometry.prediction import Expectation
from perception.markers.centres import Detection, find_markers
from perception.markers.circumstances import Candidates
from perception.markers.marker_fix import Rejection, with_note
from perception.markers.observation import Observation
from perception.markers.plausibility import choose

FALSE_ALARM_RATE = 0.2  # per window and LED; high, as the joint check comes after


_NAMES = ("left", "right")


@dataclass(frozen=True, eq=False)
class SeenSingly:
    """Candidates [camera][marker], the dark images, and what makes the frames unusable (or empty).

    A camera that shows nothing usable has no candidates at all, `[]`, and `note` says why; if neither does,
    that is the `problem`. `unknown_px` is for `frames.vibration.shaken`: how little is known of where a
    vibrating head pointed.
    """

    candidates: Candidates
    dark: Pictures | None
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


def single_observation(
    chain: Chain, data: Images | Centres, pairs: int, expectation: Expectation, tilt_rad: Vec2
) -> Observation:
    """What one shot of `pairs` on/off pairs a marker shows of the expected rover.

    ValueError unless the frames are as ordered (perception.frames.shots).
    """
    head_rad = (data.head.pan_rad, data.head.tilt_rad)
    state = replace(expectation.state, head_rad=head_rad)
    seen = find_candidates(chain.rig, data, plate_view(chain, state).range_m)
    chain = shaken(chain, seen.unknown_px)
    fix = choose(chain, seen.candidates, head_rad, state.joints_rad, tilt_rad, expectation.prior)
    fix = with_note(fix, seen.note)
    detected_px = seen.strongest_px if isinstance(fix, Rejection) else fix.detected_px
    return Observation(data, pairs, len(data.shot.leds), seen.problem, fix, seen.dark, detected_px)


def find_candidates(rig: RigCalibration, data: Images | Centres, range_m: float) -> SeenSingly:
    """Marker candidates in what the cameras returned, markers expected at about `range_m`.

    ValueError unless the frames are as ordered (perception.frames.shots).
    """
    if isinstance(data, Centres):
        return SeenSingly(_given(data), None)
    check_frames(data, rig.sensor)
    cameras = [_detect(rig, data, camera, range_m) for camera in (0, 1)]
    black = blackness((float(np.median(cameras[0].dark)), float(np.median(cameras[1].dark))))
    problems = [dark or camera.problem for dark, camera in zip(black, cameras, strict=True)]
    named = "; ".join(f"{name} camera: {why}" for name, why in zip(_NAMES, problems, strict=True) if why)
    blind = all(problems)
    candidates = [
        [] if why and not blind else camera.candidates for camera, why in zip(cameras, problems, strict=True)
    ]
    dark = cameras[0].dark, cameras[1].dark
    unknown = tuple(camera.unknown_px for camera in cameras)
    return SeenSingly(candidates, dark, named if blind else "", "" if blind else named, unknown)


@dataclass(frozen=True, eq=False)
class _Seen:
    """One camera's candidates by marker, dark image, problem, and how little the pointing is known [px]."""

    candidates: list[list[Detection]]
    dark: NDArray[np.float32]
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
