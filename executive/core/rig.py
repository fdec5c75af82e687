"""A rig's calibration as values: what the executive needs of any (`Rig`), and all of the first robot's.

`RigCalibration` has cameras, head, markers and cabin joints, which simulation and perception of that robot
share; no algorithm of the executive reads more than `Rig`. No projection code here.

Simulation and perception each bring their own projection, so an error in one shows in the other.
Angles in rad, lengths in m, image quantities in px. Frames: docs/frames.md.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, Protocol

from executive.core.types import Vec2, Vec3


class Vehicle(Protocol):
    """The part of a rig that moves: its size, how it drives, and what it must never be exposed to.

    `tether_limit_n` is None for a vehicle without a tether.
    """

    @property
    def length_m(self) -> float: ...
    @property
    def width_m(self) -> float: ...
    @property
    def track_gauge_m(self) -> float:
        """Distance between the middles of the belts, or of the wheels of both sides."""
        ...

    @property
    def speed_m_s(self) -> float:
        """Of the faster belt in a drive."""
        ...

    @property
    def tilt_limit_rad(self) -> float: ...
    @property
    def tether_limit_n(self) -> float | None: ...


class Rig(Protocol):
    """What every backend's rig has, a frozen dataclass whose fields all have defaults."""

    @property
    def rover(self) -> Vehicle: ...


ARC_MINUTE_RAD = math.pi / (180 * 60)


@dataclass(frozen=True)
class CameraCalibration:
    """One camera. `position_ih_m`, yaw (left positive), pitch (down positive) and roll place it in `ih`.

    R_ih_cam = Rz(yaw) Ry(pitch) Rx(roll) A; at zero, A: z along ih x (forward), x along -ih y (right), y
    along -ih z (down).
    `distortion` is (k1, k2, p1, p2, k3), the Brown-Conrady model as OpenCV defines it.
    """

    focal_px: float = 2500.0
    principal_px: Vec2 = (511.5, 511.5)
    width_px: int = 1024
    height_px: int = 1024
    distortion: tuple[float, float, float, float, float] = (0.0, 0.0, 0.0, 0.0, 0.0)
    position_ih_m: Vec3 = (0.0, 0.0, 0.0)
    yaw_ih_rad: float = 0.0
    pitch_ih_rad: float = 0.0
    roll_ih_rad: float = 0.0


@dataclass(frozen=True)
class HeadCalibration:
    """The pan-tilt unit: `ih` sits at its crossing axes, `mast_height_m` over the site origin.

    R_site_ih = Ry(lean[1]) Rx(lean[0]) Rz(pan + pan_zero) Rx(axes_skew) Ry(tilt + tilt_zero): pan positive to
    the left, tilt positive downwards, both as the encoders read them.
    Accuracies are the half-widths of a uniform error, drawn anew at each move (paper, table 1).
    """

    mast_height_m: float = 1.5
    pan_accuracy_rad: float = 0.94 * ARC_MINUTE_RAD
    tilt_accuracy_rad: float = 0.465 * ARC_MINUTE_RAD
    pan_zero_rad: float = 0.0
    tilt_zero_rad: float = 0.0
    lean_rad: Vec2 = (0.0, 0.0)
    axes_skew_rad: float = 0.0
    pan_limit_rad: float = math.radians(175.0)
    tilt_limits_rad: Vec2 = (math.radians(-30.0), math.radians(80.0))
    speed_rad_s: float = math.radians(3.0)


@dataclass(frozen=True)
class CabinCalibration:
    """The payload cabin's joints: body -> arm (about body y) -> cabin (about y) -> plc.

    T_body_plc = Trans(arm_pivot_body_m) Ry(-arm) Trans(arm_length_m, 0, 0) Ry(arm - cabin)
                 Trans(plc_offset_cabin_m).
    `arm` lifts the cabin's pivot (positive up); `cabin` tilts the marker plane against the body, positive
    nose-up, so that its normal leans backwards (towards body -x). At (0, 0) the plane is level with the body.
    """

    arm_pivot_body_m: Vec3 = (-0.080, 0.0, 0.070)
    arm_length_m: float = 0.110
    plc_offset_cabin_m: Vec3 = (0.0, 0.0, 0.060)
    arm_limits_rad: Vec2 = (0.0, math.radians(60.0))
    cabin_limits_rad: Vec2 = (math.radians(-60.0), math.radians(60.0))
    joint_sigma_rad: float = math.radians(0.05)
    speed_rad_s: float = math.radians(2.0)


@dataclass(frozen=True)
class RoverCalibration:
    """The rover as drawn: sizes and masses of the paper's table 2.

    The limits are what it must never be exposed to, whatever happens: `tilt_limit_rad` leaves a margin to the
    25 degrees at which drives stop, `tether_limit_n` is about its own weight on Mars.
    """

    length_m: float = 0.340
    width_m: float = 0.165
    height_m: float = 0.130
    track_gauge_m: float = 0.125
    speed_m_s: float = 0.0014
    rover_mass_kg: float = 1.45
    payload_mass_kg: float = 1.10
    tether_length_m: float = 100.0
    inclinometer_sigma_rad: float = math.radians(0.1)
    tilt_limit_rad: float = math.radians(30.0)
    tether_limit_n: float = 10.0


@dataclass(frozen=True)
class ShapeCalibration:
    """The rover's solids as drawn: two belts (flat with round ends), chassis, arm and cabin as boxes.

    Belts: `belt_shorter_m` less than the rover's length, as wide as the rover exceeds its gauge. The chassis
    hangs between them with `chassis_gap_m` in all, its belly `belly_clearance_m` over the ground. The arm's
    bar runs from its pivot to the cabin's; the cabin's top is the marker plane. Painted on the cabin: a plate
    of `plate_m` (length, width) on its top, an opening of `opening_m` (width, height) in its front.
    """

    belt_radius_m: float = 0.033
    belt_shorter_m: float = 0.020
    belly_clearance_m: float = 0.020
    chassis_length_m: float = 0.270
    chassis_height_m: float = 0.044
    chassis_gap_m: float = 0.005
    cabin_size_m: Vec3 = (0.160, 0.120, 0.054)
    arm_width_m: float = 0.080
    arm_thickness_m: float = 0.010
    plate_m: Vec2 = (0.090, 0.060)
    opening_m: Vec2 = (0.050, 0.026)


@dataclass(frozen=True)
class MarkerCalibration:
    """The four LEDs in the plane z = 0 of frame `plc` (the paper's OCS) [m].

    Identity comes from lighting one at a time, so the layout may be symmetric. `emission` is how the
    intensity falls with the angle from the plane's normal: `dome` as (1 + cos) / 2, a diffusing dome's
    projected area; `lambertian` as max(cos, 0).
    """

    positions_plc_m: tuple[Vec3, ...] = (
        (0.060, 0.045, 0.0),
        (0.060, -0.045, 0.0),
        (-0.060, -0.045, 0.0),
        (-0.060, 0.045, 0.0),
    )
    size_m: float = 0.003
    emission: Literal["dome", "lambertian"] = "dome"


@dataclass(frozen=True)
class SensorCalibration:
    """What the executive knows of the sensor: enough to weigh pixels, not to make them.

    `noise_counts` is the standard deviation of one background pixel; `snr_1_range_m` the range at which
    the brightest pixel of a one-pair difference image equals its noise (paper, section 4.2).
    """

    bits: int = 10
    psf_sigma_px: float = 0.5
    defocus_px_m: float = 5.47
    focus_m: float = 20.0
    noise_counts: float = 1.7
    snr_1_range_m: float = 7.5


_VERGENCE_RAD = math.radians(5.0)


@dataclass(frozen=True)
class RigCalibration:
    """All of it; the one object that simulation and perception share."""

    cameras: tuple[CameraCalibration, CameraCalibration] = (
        CameraCalibration(position_ih_m=(0.0, 0.25, 0.0), yaw_ih_rad=-_VERGENCE_RAD),
        CameraCalibration(position_ih_m=(0.0, -0.25, 0.0), yaw_ih_rad=_VERGENCE_RAD),
    )
    head: HeadCalibration = HeadCalibration()
    cabin: CabinCalibration = CabinCalibration()
    rover: RoverCalibration = RoverCalibration()
    shape: ShapeCalibration = ShapeCalibration()
    markers: MarkerCalibration = MarkerCalibration()
    sensor: SensorCalibration = SensorCalibration()
