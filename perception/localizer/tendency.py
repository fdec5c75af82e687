"""Motion fragments, while moving: two frames, a coarse pose (quality `trend`)."""

from __future__ import annotations

from executive.core.clock import Clock
from executive.core.devices import CAMERAS
from executive.core.ports import Devices, LocaliseRequest
from executive.core.types import Localisation, Outcome, Reason, Shot
from perception.frames.exposure import plate_view
from perception.frames.routine import Steps, wait_for
from perception.geometry.chain import Chain
from perception.localizer.aim import Aim
from perception.localizer.trend import (
    CADENCE_S,
    LEDS,
    coarse_pose,
    window_margin_px,
)
from perception.markers.detector import MarkerDetector


class Tendency:
    """Takes two frames of the expected rover."""

    def __init__(
        self, devices: Devices, chain: Chain, clock: Clock, aim: Aim, detector: MarkerDetector
    ) -> None:
        self._devices, self._chain, self._clock = devices, chain, clock
        self._aim, self._detector = aim, detector

    def measure(self, request: LocaliseRequest, deadline_s: float) -> Steps[Outcome[Localisation]]:
        """Two frames, fragments, a coarse pose."""
        failed = yield from self._aim.turn_to(request.predicted, (0.0, 0.0), deadline_s)
        if failed is not None:
            return Outcome(failed.reason, failed.detail)
        expectation = self._aim.expectation(request.predicted)
        range_m = plate_view(self._chain, expectation.state).range_m
        windows = self._detector.windows(expectation, 1.0, window_margin_px(self._chain.rig, range_m))
        shot = Shot(LEDS, windows, CADENCE_S)
        start_s = self._clock.now_s
        taken = yield from wait_for(self._devices[CAMERAS].take(shot), self._clock, deadline_s)
        if taken.value is None or not taken.ok:
            return Outcome(taken.reason, f"cameras: {taken.detail}")
        pose = coarse_pose(self._chain, expectation, request.predicted, taken.value, start_s)
        if pose is None:
            return Outcome(Reason.NOT_SEEN, "nothing moved between two frames")
        return Outcome(Reason.DONE, value=Localisation(pose))
