"""Faults of the image sensors and the optics: exposure, hot pixels, a calibration that no longer holds."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import cv2
import numpy as np
from pydantic import Field

from executive.core.ports import Devices
from executive.core.rig import RigCalibration
from executive.core.types import (
    LEFT,
    RIGHT,
    Array,
    Centres,
    Images,
    Landmarks,
    Window,
)
from executive.core.units import Fraction
from executive.run import Cue, FaultSpec
from proving.faults.cameras import CameraFault, Counts, no_ground, with_counts, with_ground
from proving.faults.parameters import SIDES, OneCamera, Parameters

RIG = RigCalibration()
FULL_COUNTS = 2**RIG.sensor.bits - 1
WIDTH_PX, HEIGHT_PX = RIG.cameras[0].width_px, RIG.cameras[0].height_px
SATURATION_FACTOR = 2.5  # exposed as it should be, the ground takes two fifths of the range
FAINTEST_SIGMA_PX = 0.5  # a marker whose centre is worse than this does not stand out from the noise
HOT_REACH_PX = 2.0  # a hot pixel this near to a marker's centre lies under its spot


class ExposureFactor(Parameters):
    """How much light the frames get, of what they should get."""

    factor: Annotated[
        Fraction, Field(gt=0, le=20, description="exposure, of the right one; above 100 % is too bright")
    ] = 0.2


class ExposureOff(CameraFault):
    """Too dark or too bright, by a power of the factor along a ramp.

    Geometric: in the dark the centres are the worse for it, or lost; lost too where the ground saturates.
    """

    def __init__(self, parameters: ExposureFactor) -> None:
        self._factor = parameters.factor

    def images(self, answer: Images, level: float) -> Images:
        left, right = (self._exposed(counts, self._factor**level) for counts in answer.counts)
        return replace(answer, counts=(left, right))

    @staticmethod
    def _exposed(counts: Counts, factor: float) -> Counts:
        exposed: Counts = np.clip(np.rint(counts * np.float32(factor)), 0, FULL_COUNTS).astype(np.uint16)
        return exposed

    def centres(self, answer: Centres, level: float) -> Centres:
        factor = self._factor**level
        sigma_px = answer.sigma_px / min(factor, 1.0)
        lost = (sigma_px > FAINTEST_SIGMA_PX) & np.any(answer.shot.leds) | (factor >= SATURATION_FACTOR)
        uv_px = np.where(lost[..., None], np.nan, answer.uv_px)
        after = replace(answer, uv_px=uv_px, sigma_px=sigma_px)
        if factor >= SATURATION_FACTOR:
            after = with_ground(with_ground(after, LEFT, no_ground), RIGHT, no_ground)
        return after


class HotPixelCount(Parameters):
    """How many."""

    count: Annotated[int, Field(ge=1, le=200_000, description="hot pixels in each camera")] = 1000


class HotPixels(CameraFault):
    """Pixels, drawn once, that are saturated in every frame.

    Geometric: a marker whose spot lies over one is lost, for nothing lit shows in a saturated pixel.
    """

    def __init__(self, parameters: HotPixelCount) -> None:
        self._count = parameters.count
        self._uv_px: Array = np.empty((2, 0, 2))

    def wrap(self, devices: Devices, cue: Cue) -> Devices:
        self._uv_px = cue.rng.integers(0, (WIDTH_PX, HEIGHT_PX), (2, self._count, 2)).astype(float)
        return super().wrap(devices, cue)

    def images(self, answer: Images, level: float) -> Images:
        left, right = (self._with_hot(answer, camera) for camera in (0, 1))
        return replace(answer, counts=(left, right))

    def _with_hot(self, answer: Images, camera: int) -> Counts:
        window = answer.windows[camera]
        u, v = (self._uv_px[camera] - (window.u, window.v)).astype(int).T
        inside = (u >= 0) & (u < window.width) & (v >= 0) & (v < window.height)
        counts = answer.counts[camera].copy()
        counts[:, v[inside], u[inside]] = FULL_COUNTS
        return counts

    def centres(self, answer: Centres, level: float) -> Centres:
        apart = np.linalg.norm(answer.uv_px[:, :, None] - self._uv_px[:, None], axis=-1)  # (2, 4, count)
        under = (apart <= HOT_REACH_PX).any(axis=-1) & np.any(answer.shot.leds)
        return replace(answer, uv_px=np.where(under[..., None], np.nan, answer.uv_px))


class Drift(OneCamera):
    """How far one camera's image has moved against its calibration, pixels to the right and down."""

    u: Annotated[float, Field(ge=-100, le=100, description="shift to the right [px]")] = 3.0
    v: Annotated[float, Field(ge=-100, le=100, description="shift down [px]")] = 0.0
    scale: Annotated[
        Fraction, Field(ge=0.9, le=1.1, description="size of the image, about the middle of the frame")
    ] = 1.0


class CalibrationDrift(CameraFault):
    """One camera's image lies elsewhere than its calibration says, all of it along a ramp."""

    def __init__(self, parameters: Drift) -> None:
        self._drift, self._camera = parameters, SIDES.index(parameters.camera)

    def _affine(self, level: float, origin_px: tuple[int, int] = (0, 0)) -> Array:
        """The (2, 3) map from where a point should lie to where it lies, in pixels from `origin_px`."""
        scale = 1.0 + level * (self._drift.scale - 1.0)
        middle = np.array([(WIDTH_PX - 1) / 2, (HEIGHT_PX - 1) / 2]) - origin_px
        shift = level * np.array([self._drift.u, self._drift.v]) + (1.0 - scale) * middle
        return np.array([[scale, 0.0, shift[0]], [0.0, scale, shift[1]]])

    def images(self, answer: Images, level: float) -> Images:
        window = answer.windows[self._camera]
        moved = _warped(answer.counts[self._camera], self._affine(level, (window.u, window.v)), window)
        return with_counts(answer, self._camera, moved)

    def centres(self, answer: Centres, level: float) -> Centres:
        M, uv_px = self._affine(level), answer.uv_px.copy()
        uv_px[self._camera] = uv_px[self._camera] @ M[:, :2].T + M[:, 2]
        moved = replace(answer, uv_px=uv_px)
        return with_ground(moved, self._camera, lambda g: Landmarks(g.names, g.uv_px @ M[:, :2].T + M[:, 2]))


def _warped(stack: Counts, affine: Array, window: Window) -> Counts:
    """Each frame moved; what moves in from outside the window repeats its edge."""
    size = (window.width, window.height)
    moved = [cv2.warpAffine(frame, affine, size, borderMode=cv2.BORDER_REPLICATE) for frame in stack]
    return np.stack(moved).astype(np.uint16)


EXPOSURE_OFF = FaultSpec(
    "exposure_off",
    "The frames are exposed too little or too much: all counts are scaled, and clipped.",
    ExposureFactor,
    ExposureOff,
    "marker_lost",
    category="cameras",
    graded=True,
)
HOT_PIXELS = FaultSpec(
    "hot_pixels",
    "Pixels drawn at random, the same in every frame, are saturated.",
    HotPixelCount,
    HotPixels,
    "marker_lost",
    category="cameras",
)
CALIBRATION_DRIFT = FaultSpec(
    "calibration_drift",
    "One camera's image is shifted and scaled against its calibration.",
    Drift,
    CalibrationDrift,
    "head_misaligned",
    category="cameras",
    graded=True,
)
