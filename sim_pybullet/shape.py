"""The rover's shape: boxes and belts within the paper's 340 x 165 x 130 mm. Physics and pictures share it.

With both joints at 0 the marker plane is the top, 130 mm above the track contact plane.
"""

from __future__ import annotations

from dataclasses import dataclass

from executive.core.rig import RigCalibration
from executive.core.types import Vec3
from sim_pybullet.scene import Box

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


def belt(rig: RigCalibration) -> Belt:
    """The belt that fits the rover's length, width and gauge."""
    rover, shape = rig.rover, rig.shape
    return Belt(
        rover.length_m - shape.belt_shorter_m, rover.width_m - rover.track_gauge_m, shape.belt_radius_m
    )


def chassis(rig: RigCalibration) -> Box:
    """The box between the tracks, with its belly clear of the ground."""
    shape = rig.shape
    width_m = rig.rover.track_gauge_m - belt(rig).width_m - shape.chassis_gap_m
    centre_m = (0.0, 0.0, shape.belly_clearance_m + shape.chassis_height_m / 2)
    return Box("chassis", "body", centre_m, (shape.chassis_length_m, width_m, shape.chassis_height_m))


def cabin(rig: RigCalibration) -> Box:
    """The payload cabin: its top is the marker plane."""
    top, size_m = rig.cabin.plc_offset_cabin_m, rig.shape.cabin_size_m
    return Box("cabin", "cabin", (top[0], top[1], top[2] - size_m[2] / 2), size_m)


def arm(rig: RigCalibration) -> Box:
    """The arm: a bar from its pivot to the cabin's."""
    length_m = rig.cabin.arm_length_m
    size_m = (length_m, rig.shape.arm_width_m, rig.shape.arm_thickness_m)
    return Box("arm", "arm", (length_m / 2, 0.0, 0.0), size_m)


def rover_boxes(rig: RigCalibration) -> tuple[Box, ...]:
    """Every visible box of the rover; the two tracks as cuboids around their stadium."""
    b = belt(rig)
    tracks = (
        Box(
            name,
            "body",
            (0.0, side * rig.rover.track_gauge_m / 2, b.radius_m),
            (b.length_m, b.width_m, 2 * b.radius_m),
        )
        for name, side in (("left track", 1.0), ("right track", -1.0))
    )
    return (*tracks, chassis(rig), arm(rig), cabin(rig))
