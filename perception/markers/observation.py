"""One look at the rover: what was taken, what it cost, and the marker fix that it gives or why none."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from executive.core.types import Array, CameraView, Centres, Images, PoseEstimate, Reason
from perception.frames.views import Pictures, camera_views
from perception.geometry.chain import pose_estimate
from perception.geometry.prediction import Expectation
from perception.markers.marker_fix import MarkerFix, Rejection


@dataclass(frozen=True, eq=False)
class Observation:
    """What came of a look: the last data, the pairs and frames it cost, what makes the frames unusable (or
    empty), the fix or why there is none; for people the dark images and the centres found (2, n, 2)."""

    data: Images | Centres
    pairs: int
    frames: int
    problem: str
    fix: MarkerFix | Rejection
    dark: Pictures | None
    detected_px: Array

    @property
    def views(self) -> tuple[CameraView, ...]:
        """Dark images with the centres found, and where the fix has them."""
        nowhere = np.full_like(self.detected_px, np.nan)
        expected_px = nowhere if isinstance(self.fix, Rejection) else self.fix.fit.reprojected_px
        return camera_views(self.data, self.dark, self.detected_px, expected_px)

    @property
    def cost(self) -> str:
        """In words, with what is odd about the fix."""
        took_s = self.frames * self.data.shot.cadence_s
        note = "" if isinstance(self.fix, Rejection) or not self.fix.note else f"; {self.fix.note}"
        return f"{self.pairs} pairs, {self.frames} frames in {took_s:.0f} s{note}"

    def objection(self, expectation: Expectation) -> tuple[Reason, str] | None:
        """What speaks against this look as a measurement of the expected rover; None if nothing does."""
        if self.problem:
            return Reason.UNSTABLE_IMAGES, self.problem
        if isinstance(self.fix, Rejection):
            return (Reason.NOT_SEEN if self.fix.seen < 2 else Reason.IMPLAUSIBLE), self.fix.why
        misfit = expectation.misfit(self.fix.fit.state.site_body, self.fix.fit.covariance)
        return (Reason.IMPLAUSIBLE, misfit) if misfit else None

    def pose(self, source: str) -> PoseEstimate | None:
        """The rover's pose at the time of the data, None where there is no fix."""
        if isinstance(self.fix, Rejection):
            return None
        fit = self.fix.fit
        return pose_estimate(self.data.time_s, fit.state.site_body, fit.covariance, source, self.fix.markers)
