"""Coarser pixels for a near rover: it fills so many that fine ones only cost time."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from executive.core.rig import CameraCalibration, RigCalibration
from executive.core.types import Array, Window

_LEAST_LENGTH_PX = 40.0  # of the rover, that is kept


def binning_for(rig: RigCalibration, range_m: float) -> int:
    """Pixels a side that are summed into one at this range."""
    length_px = rig.cameras[0].focal_px * rig.rover.length_m / range_m
    return max(1, int(length_px / _LEAST_LENGTH_PX))


Frames = NDArray[Any]  # (n, h, w), counts of one kind or another


def binned_rig(rig: RigCalibration, by: int) -> RigCalibration:
    """The rig whose pixels are means of `by` x `by` of the real ones."""
    left, right = (_binned_camera(camera, by) for camera in rig.cameras)
    sensor = replace(
        rig.sensor,
        psf_sigma_px=rig.sensor.psf_sigma_px / by,
        defocus_px_m=rig.sensor.defocus_px_m / by,
        noise_counts=rig.sensor.noise_counts / by,
    )
    return replace(rig, cameras=(left, right), sensor=sensor)


def binned(frames: Frames, window: Window, by: int) -> tuple[Array, Window]:
    """Frames (n, h, w) of a window in coarser pixels, and the window that these fill."""
    u, v = -(-window.u // by), -(-window.v // by)
    width, height = (window.u + window.width) // by - u, (window.v + window.height) // by - v
    top, left = v * by - window.v, u * by - window.u
    part = frames[:, top : top + height * by, left : left + width * by]
    coarse = part.reshape(len(frames), height, by, width, by).mean(axis=(2, 4))
    return np.asarray(coarse, dtype=np.float64), Window(u, v, width, height)


def _binned_camera(camera: CameraCalibration, by: int) -> CameraCalibration:
    u, v = ((p + 0.5) / by - 0.5 for p in camera.principal_px)
    return replace(
        camera,
        focal_px=camera.focal_px / by,
        principal_px=(u, v),
        width_px=camera.width_px // by,
        height_px=camera.height_px // by,
    )
