"""Move the payload cabin, which carries the markers."""

from __future__ import annotations

import math

from executive.core.devices import CABIN
from executive.core.ports import Action
from executive.core.rig import RigCalibration
from executive.core.types import CabinReading, Outcome, PoseEstimate, Reason
from executive.core.values import ANGLE, POSE
from executive.tree.nodes.action import ActionLeaf
from executive.tree.nodes.base import In


class SetCabin(ActionLeaf):
    """Move the arm and cabin joints to these angles."""

    needs = ("cabin",)

    arm = In[float](ANGLE, "lift of the arm", default=0.0)
    cabin = In[float](ANGLE, "tilt of the cabin, nose up positive", default=0.0)

    outcomes = (Reason.DONE, Reason.OUT_OF_REACH, Reason.BLOCKED, Reason.DEVICE)

    def request(self) -> Action[CabinReading]:
        return self.services.devices[CABIN].move(self.arm, self.cabin)


class ShowMarkers(ActionLeaf):
    """Tilt the cabin so that the marker plane faces the head as squarely as its joints allow."""

    needs = ("cabin", "head")

    pose = In[PoseEstimate](POSE, "the pose")
    arm = In[float](ANGLE, "lift of the arm, to look over what hides the markers", default=math.radians(20.0))

    outcomes = (Reason.DONE, Reason.OUT_OF_REACH, Reason.BLOCKED, Reason.DEVICE)

    def request(self) -> Action[CabinReading] | Outcome[CabinReading]:
        rig = self.services.rig
        if not isinstance(rig, RigCalibration):
            return Outcome(Reason.DEVICE, f"a {type(rig).__name__} does not say how its cabin turns")
        low, high = rig.cabin.cabin_limits_rad
        wanted = best_cabin_tilt_rad(self.pose, rig.head.mast_height_m)
        return self.services.devices[CABIN].move(self.arm, min(max(wanted, low), high))


def best_cabin_tilt_rad(pose: PoseEstimate, mast_height_m: float) -> float:
    """Cabin tilt whose plane normal, in the body's x-z plane, points nearest to the head.

    The normal leans back by the tilt (rig: R = Ry(-tilt)), so it is (-sin, 0, cos) in the body.
    """
    x, y, z = pose.position_site_m
    forward = -(math.cos(pose.heading_rad) * x + math.sin(pose.heading_rad) * y)
    return math.atan2(-forward, mast_height_m - z)
