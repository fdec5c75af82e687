"""The rover's shape: boxes and belts within the paper's 340 x 165 x 130 mm. Physics and pictures share it.

With both joints at 0 the marker plane is the top, 130 mm above the track contact plane.
"""

from __future__ import annotations

from dataclasses import dataclass

from executive.rig import RigCalibration, RoverCalibration
from executive.types import Vec3
from sim_pybullet.scene import Box

TRACK_RADIUS_M = 0.033
TRACK_SHORTER_M = 0.020  # the belt's flat part ends before the housing does
BELLY_CLEARANCE_M = 0.020
CHASSIS_HEIGHT_M = 0.044
CHASSIS_LENGTH_M = 0.270
CABIN_SIZE_M: Vec3 = (0.160, 0.120, 0.054)
ARM_THICKNESS_M = 0.010
TETHER_ANCHOR_BODY_M: Vec3 = (-0.165, 0.0, 0.045)


@dataclass(frozen=True)
class Belt:
    """A stadium: a flat part between two end cylinders; centre at (0, +-gauge/2, radius) of `body`."""

    length_m: float
    width_m: float
    radius_m: float

    @property
    def flat_m(self) -> float:
        """Length of the part that lies flat on level ground."""
        return self.length_m - 2 * self.radius_m


def belt(rover: RoverCalibration) -> Belt:
    """The belt that fits the rover's length, width and gauge."""
    return Belt(rover.length_m - TRACK_SHORTER_M, rover.width_m - rover.track_gauge_m, TRACK_RADIUS_M)


def chassis(rover: RoverCalibration) -> Box:
    """The box between the tracks, with its belly clear of the ground."""
    width_m = rover.track_gauge_m - belt(rover).width_m - 0.005
    centre_m = (0.0, 0.0, BELLY_CLEARANCE_M + CHASSIS_HEIGHT_M / 2)
    return Box("chassis", "body", centre_m, (CHASSIS_LENGTH_M, width_m, CHASSIS_HEIGHT_M))


def cabin(rig: RigCalibration) -> Box:
    """The payload cabin: its top is the marker plane."""
    top = rig.cabin.plc_offset_cabin_m
    return Box("cabin", "cabin", (top[0], top[1], top[2] - CABIN_SIZE_M[2] / 2), CABIN_SIZE_M)


def arm(rig: RigCalibration) -> Box:
    """The arm: a bar from its pivot to the cabin's."""
    length_m = rig.cabin.arm_length_m
    return Box("arm", "arm", (length_m / 2, 0.0, 0.0), (length_m, 0.080, ARM_THICKNESS_M))


def rover_boxes(rig: RigCalibration) -> tuple[Box, ...]:
    """Every visible box of the rover; the two tracks as cuboids around their stadium."""
    b = belt(rig.rover)
    tracks = (
        Box(
            name,
            "body",
            (0.0, side * rig.rover.track_gauge_m / 2, b.radius_m),
            (b.length_m, b.width_m, 2 * b.radius_m),
        )
        for name, side in (("left track", 1.0), ("right track", -1.0))
    )
    return (*tracks, chassis(rig.rover), arm(rig), cabin(rig))
