"""The yard robot as drawn: the husky, the box of markers on its back, the camera on its pole.

Frames: `site` has its origin at the foot of the pole, z up. `body` has its origin on the ground between the
wheels, x ahead, y left. Lengths in m, angles in rad, image quantities in px.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

Vec3 = tuple[float, float, float]


@dataclass(frozen=True)
class Husky:
    """The chassis. `track_gauge_m` is the effective one: a skid-steered robot turns as if it were wider."""

    wheel_radius_m: float = 0.17775
    wheel_width_m: float = 0.114
    wheel_track_m: float = 0.5708
    axle_m: float = 0.256
    chassis_width_m: float = 0.45
    chassis_height_m: float = 0.25
    chassis_middle_m: float = 0.27
    track_gauge_m: float = 0.8562
    speed_m_s: float = 0.3
    mass_kg: float = 49.0
    length_m: float = 0.99
    width_m: float = 0.67
    height_m: float = 0.82
    tilt_limit_rad: float = math.radians(30.0)
    tether_limit_n: float | None = None


@dataclass(frozen=True)
class MarkerBox:
    """A box with an ArUco marker on each of five faces: `top`, `front`, `back`, `left`, `right`.

    `edge_m` is the box's edge, `marker_m` that of a marker's black square, `cells` its cells a side: four
    bits, and a border of one cell on each side.
    """

    centre_body_m: Vec3 = (0.0, 0.0, 0.60)
    edge_m: float = 0.44
    marker_m: float = 0.33
    cells: int = 6


@dataclass(frozen=True)
class PoleCamera:
    """A fixed camera, `height_m` over the foot of its pole, looking ahead (site x), `pitch_rad` downwards.

    Pinhole without distortion. `noise_counts` is the standard deviation of one pixel, of 255 counts.
    """

    height_m: float = 5.0
    pitch_rad: float = math.radians(39.0)
    focal_px: float = 1700.0
    width_px: int = 2048
    height_px: int = 1536
    noise_counts: float = 2.0
    exposure_s: float = 2.0


@dataclass(frozen=True)
class YardRig:
    """All of it; what simulation and localizer share."""

    rover: Husky = Husky()
    box: MarkerBox = MarkerBox()
    camera: PoleCamera = PoleCamera()
