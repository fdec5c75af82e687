"""The geometric tier's answer to a coded look: centres of several shots, and the pose that they give."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from executive.core.types import Array, Centres, Vec2
from perception.geometry.body import Transform
from perception.geometry.chain import Chain
from perception.geometry.pose import Sighting, chi2_limit, estimate
from perception.geometry.prediction import Expectation
from perception.geometry.rotation import rot_z
from perception.markers.marker_fix import MarkerFix, Rejection, faces_cameras

_GATE = 0.999
_HEADINGS = 9  # starts over the heading's uncertainty


@dataclass(frozen=True, eq=False)
class MeanCentres:
    """Centres (2, n, 2) weighted by their variances, with the sum of weights (2, n)."""

    weighted_px: Array
    weight: Array

    @classmethod
    def none(cls, markers: int) -> MeanCentres:
        return cls(np.zeros((2, markers, 2)), np.zeros((2, markers)))

    def with_shot(self, shot: Centres) -> MeanCentres:
        seen = np.isfinite(shot.uv_px).all(axis=-1) & (shot.sigma_px > 0)
        weight = np.where(seen, 1 / np.where(seen, shot.sigma_px, 1.0) ** 2, 0.0)
        centres = np.where(seen[..., None], shot.uv_px, 0.0)
        return MeanCentres(self.weighted_px + weight[..., None] * centres, self.weight + weight)

    def sighting(self, head_rad: Vec2, joints_rad: Vec2, tilt_rad: Vec2) -> Sighting:
        seen = (self.weight > 0).all(axis=0)
        weight = np.where(seen, self.weight, np.nan)
        covariance = np.eye(2) / weight[..., None, None]
        return Sighting(self.weighted_px / weight[..., None], covariance, head_rad, joints_rad, tilt_rad)


def fix_from_centres(
    chain: Chain, centres: MeanCentres, expectation: Expectation, tilt_rad: Vec2
) -> MarkerFix | Rejection:
    """The pose of given centres on the known surface, climbed from several headings."""
    state = expectation.state
    sighting = centres.sighting(state.head_rad, state.joints_rad, tilt_rad)
    seen = int(np.isfinite(sighting.uv_px).all(axis=(0, 2)).sum())
    if seen < 2:
        return Rejection(f"{seen} of {len(chain.markers_plc_m)} markers seen by both cameras, 2 needed", seen)
    fits = [estimate(chain, sighting, start, expectation.surface) for start in _starts(expectation)]
    converged = [fit for fit in fits if fit.converged and faces_cameras(chain, fit)]
    if not converged:
        return Rejection(f"no pose explains the {seen} markers seen", seen)
    best = min(converged, key=lambda fit: fit.chi2 + expectation.distance2(fit.state.site_body))
    fit = replace(best, dof=best.dof - 5)  # of the prior's six rows, the surface is one
    if fit.chi2 > chi2_limit(fit.dof, _GATE):
        return Rejection(f"the {seen} markers seen fit no pose: chi-square {fit.chi2:.0f} of {fit.dof}", seen)
    return MarkerFix(fit, sighting.uv_px, f"chi-square {fit.chi2:.1f} of {fit.dof}")


def _starts(expectation: Expectation) -> Iterator[Transform]:
    body = expectation.state.site_body
    reach = min(3 * float(np.sqrt(expectation.covariance[5, 5])), np.pi)
    for turn in np.linspace(-reach, reach, _HEADINGS):
        yield Transform(rot_z(float(turn)) @ body.rotation, body.position_m)
