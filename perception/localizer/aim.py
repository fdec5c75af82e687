"""Where the head looks and what is expected there: the part of a localisation that is no looking yet."""

from __future__ import annotations

import math

from executive.core.clock import Clock
from executive.core.devices import CABIN, HEAD, INCLINOMETER
from executive.core.ports import Devices
from executive.core.types import HeadReading, Outcome, PoseEstimate, Vec2
from perception.frames.routine import Steps, wait_for
from perception.geometry.body import plc_in_body
from perception.geometry.chain import Chain, body_transform
from perception.geometry.follow_up import pointing_at
from perception.geometry.prediction import Expectation, expect

_REPOINT_RAD = math.radians(1.0)


class Aim:
    """Points the head at a predicted rover, and says where the rover should then show."""

    def __init__(self, devices: Devices, chain: Chain, clock: Clock) -> None:
        self._devices, self._chain, self._clock = devices, chain, clock

    def pointing(self, pose: PoseEstimate) -> Vec2:
        """Pan and tilt [rad] that put the marker plate of this pose in the stereoscopic middle."""
        cabin = self._devices[CABIN].read()
        plc = body_transform(pose) @ plc_in_body(self._chain.rig.cabin, cabin.arm_rad, cabin.cabin_rad)
        return pointing_at(self._chain, plc.apply(self._chain.markers_plc_m).mean(axis=0))

    def turn_to(
        self, predicted: PoseEstimate, offset_rad: Vec2, deadline_s: float
    ) -> Steps[Outcome[HeadReading] | None]:
        """Bring the prediction (plus an offset) to the stereoscopic middle; an outcome if that failed."""
        pan, tilt = self.pointing(predicted)
        pan, tilt = self._clip(pan + offset_rad[0], tilt + offset_rad[1])
        now = self._devices[HEAD].read()
        off = max(abs(math.remainder(pan - now.pan_rad, 2 * math.pi)), abs(tilt - now.tilt_rad))
        if off <= _REPOINT_RAD and not now.moving:
            return None
        return (yield from self.turn((pan, tilt), deadline_s))

    def turn(self, head_rad: Vec2, deadline_s: float) -> Steps[Outcome[HeadReading] | None]:
        """Turn the head to these angles [rad]; an outcome if that failed."""
        turned = yield from wait_for(self._devices[HEAD].point(*head_rad), self._clock, deadline_s)
        return None if turned.ok else Outcome(turned.reason, f"head: {turned.detail}")

    def expectation(self, predicted: PoseEstimate) -> Expectation:
        """Where the rover should show with head, cabin and inclinometers as they are now."""
        head, cabin = self._devices[HEAD].read(), self._devices[CABIN].read()
        tilt = self._devices[INCLINOMETER].read()
        return expect(
            self._chain,
            predicted,
            (head.pan_rad, head.tilt_rad),
            (cabin.arm_rad, cabin.cabin_rad),
            (tilt.roll_rad, tilt.pitch_rad),
        )

    def _clip(self, pan: float, tilt: float) -> Vec2:
        head = self._chain.rig.head
        pan = math.remainder(pan, 2 * math.pi)
        low, high = head.tilt_limits_rad
        return min(max(pan, -head.pan_limit_rad), head.pan_limit_rad), min(max(tilt, low), high)
