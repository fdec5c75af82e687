"""Motion fragments, while moving: two frames, a coarse pose (quality `trend`)."""

from __future__ import annotations

from executive.core.clock import Clock
from executive.core.devices import CAMERAS
from executive.core.ports import Devices, LocaliseRequest
from executive.core.types import (
    Outcome,
    PoseEstimate,
    Reason,
    Shot,
)
from perception.frames.exposure import view_of
from perception.frames.routine import Steps, wait_for
from perception.geometry.chain import Chain
from perception.localizer.aim import Aim
from perception.localizer.localisation import Localisation, empty
from perception.localizer.trend import (
    CADENCE_S,
    LEDS,
    coarse_pose,
    window_margin_px,
)
from perception.markers.detector import Eyes


class Tendency:
    """Takes two frames of the expected rover. `last`: what it looked at, None if it came to no look."""

    def __init__(self, devices: Devices, chain: Chain, clock: Clock, aim: Aim, eyes: Eyes) -> None:
        self._devices, self._chain, self._clock = devices, chain, clock
        self._aim, self._eyes = aim, eyes
        self.last: Localisation | None = None

    def measure(self, request: LocaliseRequest, deadline: float) -> Steps[Outcome[PoseEstimate]]:
        """Two frames, fragments, a coarse pose."""
        self.last = None
        turned = yield from self._aim.turn_to(request.predicted, (0.0, 0.0), deadline)
        if turned is not None:
            return turned
        expectation = self._aim.expectation(request.predicted)
        range_m = view_of(self._chain, expectation.state).range_m
        windows = self._eyes.windows(expectation, 1.0, window_margin_px(self._chain.rig, range_m))
        shot = Shot(LEDS, windows, CADENCE_S)
        start_s = self._clock.now_s
        taken = yield from wait_for(self._devices[CAMERAS].take(shot), self._clock, deadline)
        if taken.value is None or not taken.ok:
            return Outcome(taken.reason, f"cameras: {taken.detail}")
        pose = coarse_pose(self._chain, expectation, request.predicted, taken.value, start_s)
        why = "" if pose is not None else "nothing moved between two frames"
        self.last = empty(
            taken.value.time_s, request.quality, len(self._chain.markers_plc_m), taken.value, 0, why
        )
        return Outcome(Reason.NOT_SEEN, why) if pose is None else Outcome(Reason.DONE, value=pose)
