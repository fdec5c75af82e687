"""The search for a fix at rest: wider and wider looks for the markers, the outline where none shows."""

from __future__ import annotations

import math

from executive.core.ports import LocaliseRequest
from executive.core.types import CameraView, Localisation, Outcome, Reason
from perception.frames.exposure import PlateView, plate_view
from perception.frames.routine import Steps
from perception.geometry.chain import Chain
from perception.localizer.aim import Aim
from perception.localizer.outlines import OutlineFix, Outlines
from perception.localizer.spec import MARKERS
from perception.markers.detector import MarkerDetector
from perception.markers.ladder import FULL_FRAMES, LADDER
from perception.markers.marker_fix import Rejection


class FixSearch:
    """Looks until there is a plausible fix, or the budget or the ladder ends."""

    def __init__(self, chain: Chain, aim: Aim, detector: MarkerDetector, outlines: Outlines | None) -> None:
        self._chain, self._aim = chain, aim
        self._detector, self._outlines = detector, outlines

    def fix(self, request: LocaliseRequest, deadline_s: float) -> Steps[Outcome[Localisation]]:
        """Climb the ladder. Where its first rung shows no marker, the outline is asked before the next."""
        why, no_outline, retaken, rung = "no time for a single look", "", False, 0
        views: tuple[CameraView, ...] = ()
        while rung < len(LADDER):
            failed = yield from self._aim.turn_to(request.predicted, LADDER[rung].offset_rad, deadline_s)
            if failed is not None:
                return Outcome(failed.reason, failed.detail, Localisation(None, views))
            expectation = self._aim.expectation(request.predicted)
            looked = yield from self._detector.look(expectation, LADDER[rung].scope, request, deadline_s)
            if looked is None:
                break
            observation = looked.value
            if observation is None:
                return Outcome(looked.reason, looked.detail, Localisation(None, views))
            views = observation.views
            objection = observation.objection(expectation)
            if objection is None:
                return Outcome(Reason.DONE, observation.cost, Localisation(observation.pose(MARKERS), views))
            reason, why = objection
            if reason is Reason.NOT_SEEN and self._outlines is not None and not no_outline:
                found = yield from self._outlines.find(request.predicted, deadline_s)
                if isinstance(found, OutlineFix):
                    detail = f"{found.note}; as {why}"
                    return Outcome(Reason.DONE, detail, Localisation(found.pose, found.views))
                no_outline = found
            cut_off = isinstance(observation.fix, Rejection) and rung < FULL_FRAMES  # by a window, maybe
            if reason is Reason.NOT_SEEN or (reason is Reason.IMPLAUSIBLE and cut_off):
                rung += 1
            elif retaken:
                return Outcome(reason, why, Localisation(observation.pose(MARKERS), views))
            else:
                retaken = True
        return self._not_seen(request, "; ".join(filter(None, (why, no_outline))), views)

    def _not_seen(
        self, request: LocaliseRequest, why: str, views: tuple[CameraView, ...]
    ) -> Outcome[Localisation]:
        """POOR_VIEW where the prediction explains that nothing was seen, NOT_SEEN otherwise."""
        expectation = self._aim.expectation(request.predicted)
        view = plate_view(self._chain, expectation.state)
        pairs, most = self._detector.most_pairs(expectation, request)
        nothing = Localisation(None, views)
        if view.cosine <= 0 or pairs > most:
            return Outcome(Reason.POOR_VIEW, f"{why}; {_describe(view, pairs)}, at most {most}", nothing)
        return Outcome(Reason.NOT_SEEN, f"{why}; {_describe(view, pairs)}", nothing)


def _describe(view: PlateView, pairs: float) -> str:
    angle = math.degrees(math.acos(max(-1.0, min(1.0, view.cosine))))
    return (
        f"expected at {view.range_m:.1f} m, {angle:.0f} deg off the plate's normal, "
        f"{pairs:.0f} pairs to see it"
    )
