"""One look at the rover, in one of two ways: each marker by itself, or all of them as one pose.

Near by, each LED is lit alone and found alone, which needs no search and bears the most disturbance. Farther
off than that pays, all LEDs are coded at once and detected jointly, in as many pairs as the quality takes.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from executive.core.clock import Clock
from executive.core.devices import CAMERAS, INCLINOMETER
from executive.core.ports import Devices, LocaliseRequest
from executive.core.rig import RigCalibration
from executive.core.types import (
    Centres,
    Images,
    Outcome,
    Quality,
    Reason,
    Shot,
    Vec2,
    Window,
)
from perception.frames.codes import coded_sequence
from perception.frames.difference import led_sequence
from perception.frames.exposure import filter_snr_per_pair, pairs_needed, plate_view
from perception.frames.metering import Metering
from perception.frames.psf import marker_spread
from perception.frames.routine import Steps, wait_for
from perception.frames.shots import overexposed
from perception.geometry.chain import Chain
from perception.geometry.prediction import Expectation
from perception.geometry.roi import full_windows, predicted_windows
from perception.markers.effort import (
    joint_pairs,
    more_pairs,
    seen_singly,
    wanted_by,
)
from perception.markers.marker_fix import Rejection
from perception.markers.observation import Observation
from perception.markers.shot_stack import ShotStack
from perception.markers.single import single_observation

MOST_PAIRS_SINGLY = {Quality.PRECISE: 64, Quality.FAR: 400}
_PIXEL_BUDGET = 32_000_000  # per camera and shot: frames x window, for memory and time
_LEAST_CODED_PAIRS = 4
_MARGIN_PX = 8.0
_WHOLE_FRAME_WIDEN = 6.0  # what a search through the whole frame takes the prediction for


@dataclass(frozen=True)
class SearchScope:
    """How wide a look is: windows so many times the prediction's (None: full frames), pairs likewise."""

    widen: float | None
    pairs_factor: float = 1.0


class MarkerDetector:
    """Takes looks with the cameras. Each ends with an observation, with the cameras' failure, or, where there
    is no time for it, with None."""

    def __init__(self, devices: Devices, rig: RigCalibration, clock: Clock) -> None:
        self._devices, self._rig, self._clock = devices, rig, clock
        self._chain = Chain.of(rig)
        self._light = Metering(devices, rig, clock)
        self._cadence_s = Shot(leds=(0,)).cadence_s

    def look(
        self, expectation: Expectation, scope: SearchScope, request: LocaliseRequest, deadline_s: float
    ) -> Steps[Outcome[Observation] | None]:
        """Look for the markers of the expected rover."""
        windows = self._marker_windows(expectation, scope)
        if self._light.exposure < 1.0:
            yield from self._light.measure(windows, deadline_s)
        way = self._singly if seen_singly(self._chain, expectation) else self._jointly
        looked = yield from way(expectation, scope, request, deadline_s)
        if (
            looked is not None
            and looked.value is not None
            and overexposed(looked.value.data, self._rig.sensor)
        ):
            showed = yield from self._light.measure(windows, deadline_s)
            if showed and self._light.exposure < looked.value.data.shot.exposure:
                return (yield from way(expectation, scope, request, deadline_s)) or looked
        return looked

    def most_pairs(self, expectation: Expectation, request: LocaliseRequest) -> tuple[float, int]:
        """Pairs that the expected view needs for detection or more, and the most that would be taken."""
        if seen_singly(self._chain, expectation):
            snr = filter_snr_per_pair(self._rig, plate_view(self._chain, expectation.state))
            return pairs_needed(snr), MOST_PAIRS_SINGLY[request.quality]
        wanted = wanted_by(request)
        return joint_pairs(self._chain, expectation, wanted), wanted.most_pairs

    def windows(
        self, expectation: Expectation, widen: float | None, margin_px: float
    ) -> tuple[Window, Window]:
        """Windows that hold the expected rover, or full frames."""
        found = None
        if widen is not None:
            found = predicted_windows(
                self._chain, expectation.state, expectation.covariance, margin_px, widen
            )
        return found or full_windows(self._chain)

    def _singly(
        self, expectation: Expectation, scope: SearchScope, request: LocaliseRequest, deadline_s: float
    ) -> Steps[Outcome[Observation] | None]:
        """Each LED by itself, reference frames between."""
        markers = len(self._chain.markers_plc_m)
        windows = self._marker_windows(expectation, scope)
        snr = filter_snr_per_pair(self._rig, plate_view(self._chain, expectation.state))
        by_memory = (self._frames_at_once(windows) - 1) // (markers + 1)
        by_time = (self._frames_until(deadline_s) - 1) // (markers + 1)
        wanted = pairs_needed(snr) * scope.pairs_factor * self._light.pairs_factor
        pairs = int(min(wanted, MOST_PAIRS_SINGLY[request.quality], max(by_memory, 1), by_time))
        if pairs < 1:
            return None
        shot = self._shot(led_sequence(markers, pairs), windows)
        taken = yield from wait_for(self._devices[CAMERAS].take(shot), self._clock, deadline_s)
        if taken.value is None or not taken.ok:
            return Outcome(taken.reason, f"cameras: {taken.detail}")
        observation = single_observation(self._chain, taken.value, pairs, expectation, self._tilt_rad)
        return Outcome(Reason.DONE, value=observation)

    def _jointly(
        self, expectation: Expectation, scope: SearchScope, request: LocaliseRequest, deadline_s: float
    ) -> Steps[Outcome[Observation] | None]:
        """All LEDs coded at once, shot upon shot, until the pose is as good as wanted."""
        wanted, windows = wanted_by(request), self._marker_windows(expectation, scope)
        at_once = max(self._frames_at_once(windows) // 2, _LEAST_CODED_PAIRS)
        most = at_once if windows == full_windows(self._chain) else wanted.most_pairs
        stack, looked, pairs = ShotStack(self._chain), None, 0
        factor = scope.pairs_factor * self._light.pairs_factor
        todo = int(min(joint_pairs(self._chain, expectation, wanted) * factor, most))
        while todo > 0:
            batch = min(todo, at_once, self._frames_until(deadline_s) // 2)
            if batch < _LEAST_CODED_PAIRS:
                break
            shot = self._shot(coded_sequence(len(self._chain.markers_plc_m), batch), windows)
            taken = yield from wait_for(self._devices[CAMERAS].take(shot), self._clock, deadline_s)
            if taken.value is None or not taken.ok:
                return Outcome(taken.reason, f"cameras: {taken.detail}")
            stack.add(taken.value)
            pairs, todo = pairs + batch, todo - batch
            if todo < _LEAST_CODED_PAIRS or stack.problem:
                observation = self._stacked(stack, taken.value, expectation, scope, pairs)
                looked = Outcome(Reason.DONE, value=observation)
                if isinstance(observation.fix, Rejection) or observation.problem or pairs >= most:
                    break
                todo = more_pairs(observation.fix.fit, pairs, wanted)
        return looked

    def _stacked(
        self,
        stack: ShotStack,
        data: Images | Centres,
        expectation: Expectation,
        scope: SearchScope,
        pairs: int,
    ) -> Observation:
        """What the shots show so far."""
        state = replace(expectation.state, head_rad=(data.head.pan_rad, data.head.tilt_rad))
        widen = _WHOLE_FRAME_WIDEN if scope.widen is None else scope.widen
        return stack.observation(data, pairs, replace(expectation, state=state), self._tilt_rad, widen)

    @property
    def _tilt_rad(self) -> Vec2:
        """Roll and pitch as the inclinometers have them now."""
        tilt = self._devices[INCLINOMETER].read()
        return tilt.roll_rad, tilt.pitch_rad

    def _marker_windows(self, expectation: Expectation, scope: SearchScope) -> tuple[Window, Window]:
        spread = marker_spread(self._rig, plate_view(self._chain, expectation.state).range_m)
        return self.windows(expectation, scope.widen, spread.radius_px + _MARGIN_PX)

    def _shot(self, leds: tuple[int, ...], windows: tuple[Window, Window]) -> Shot:
        return Shot(leds, windows, self._cadence_s, self._light.exposure)

    def _frames_at_once(self, windows: tuple[Window, Window]) -> int:
        return _PIXEL_BUDGET // max(w.width * w.height for w in windows)

    def _frames_until(self, deadline_s: float) -> int:
        return int((deadline_s - self._clock.now_s) / self._cadence_s)
