"""What of a rig is calibrated in situ: each parameter with its unit, its prior, and what it changes.

A parameter is a departure from the rig as built, zero if nothing has changed. What several of them would do
alike is one parameter by convention: the cameras' common yaw is `pan_zero`, their common pitch `tilt_zero`,
and a shift of the principal points is vergence, pan or tilt (they differ by less than 0.04 of the shift
anywhere in a frame of 23 degrees).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from executive.core.rig import CameraCalibration, RigCalibration
from executive.core.types import Array

DEGREE = math.radians(1.0)


@dataclass(frozen=True)
class RigParameter:
    """`sigma` is the standard deviation, in `unit`, of what is known before any view is taken."""

    name: str
    unit: str
    sigma: float
    doc: str


PARAMETERS = (
    RigParameter("focal", "", 5e-3, "focal length of both cameras, relative"),
    RigParameter("focal_difference", "", 1e-3, "left focal length less the right one, relative"),
    RigParameter("radial", "", 0.02, "k1 of both lenses"),
    RigParameter("vergence", "rad", 0.3 * DEGREE, "each camera turned inwards"),
    RigParameter("pitch_difference", "rad", 0.1 * DEGREE, "left camera's pitch less the right one's"),
    RigParameter("roll_difference", "rad", 0.1 * DEGREE, "left camera's roll less the right one's"),
    RigParameter("roll", "rad", 0.1 * DEGREE, "both cameras rolled in the head"),
    RigParameter("base", "", 2e-4, "distance of the cameras, relative"),
    RigParameter("marker_scale", "", 2e-4, "distances of the rover's markers, relative"),
    RigParameter("pan_zero", "rad", 1.0 * DEGREE, "true pan less the encoder's"),
    RigParameter("tilt_zero", "rad", 0.5 * DEGREE, "true tilt less the encoder's"),
    RigParameter("lean_x", "rad", 0.3 * DEGREE, "mast leaning about site x"),
    RigParameter("lean_y", "rad", 0.3 * DEGREE, "mast leaning about site y"),
    RigParameter("axes_skew", "rad", 0.05 * DEGREE, "tilt axis out of square to the pan axis"),
    RigParameter("focal_per_k", "1/K", 2e-5, "drift of both focal lengths with temperature, relative"),
    RigParameter("vergence_per_k", "rad/K", 1e-5, "drift of the vergence with temperature"),
)
NAMES = tuple(parameter.name for parameter in PARAMETERS)
_INWARDS = (-1.0, 1.0)  # the yaw that turns the left and the right camera inwards
_APART = (0.5, -0.5)  # shares of a difference


def prior_sigmas(changed: Mapping[str, float] | None = None) -> Array:
    """Prior standard deviations (k,) in the order of PARAMETERS, some of them replaced.

    ValueError for a name that is none, or a sigma that is not positive and finite.
    """
    sigmas = {parameter.name: parameter.sigma for parameter in PARAMETERS}
    for name, sigma in (changed or {}).items():
        if name not in sigmas:
            raise ValueError(f"got the parameter {name!r}, expected one of {', '.join(NAMES)}")
        if not (math.isfinite(sigma) and sigma > 0):
            raise ValueError(f"prior of {name}: got {sigma}, expected a positive number")
        sigmas[name] = sigma
    return np.array([sigmas[name] for name in NAMES])


def changed_rig(rig: RigCalibration, values: Array, warmer_k: float = 0.0) -> RigCalibration:
    """The rig with parameters (k,) changed by `values`, so much warmer than the temperature they hold for."""
    v = dict(zip(NAMES, (float(value) for value in values), strict=True))
    v["focal"] += warmer_k * v["focal_per_k"]
    v["vergence"] += warmer_k * v["vergence_per_k"]
    left, right = (_camera(camera, v, side) for side, camera in enumerate(rig.cameras))
    lean = (rig.head.lean_rad[0] + v["lean_x"], rig.head.lean_rad[1] + v["lean_y"])
    head = replace(
        rig.head,
        pan_zero_rad=rig.head.pan_zero_rad + v["pan_zero"],
        tilt_zero_rad=rig.head.tilt_zero_rad + v["tilt_zero"],
        lean_rad=lean,
        axes_skew_rad=rig.head.axes_skew_rad + v["axes_skew"],
    )
    scale = 1 + v["marker_scale"]
    plate = tuple((scale * x, scale * y, scale * z) for x, y, z in rig.markers.positions_plc_m)
    return replace(rig, cameras=(left, right), head=head, markers=replace(rig.markers, positions_plc_m=plate))


def _camera(camera: CameraCalibration, v: Mapping[str, float], side: int) -> CameraCalibration:
    x, y, z = camera.position_ih_m
    return replace(
        camera,
        focal_px=camera.focal_px * (1 + v["focal"] + _APART[side] * v["focal_difference"]),
        distortion=(camera.distortion[0] + v["radial"], *camera.distortion[1:]),
        position_ih_m=(x, y * (1 + v["base"]), z),
        yaw_ih_rad=camera.yaw_ih_rad + _INWARDS[side] * v["vergence"],
        pitch_ih_rad=camera.pitch_ih_rad + _APART[side] * v["pitch_difference"],
        roll_ih_rad=camera.roll_ih_rad + v["roll"] + _APART[side] * v["roll_difference"],
    )
