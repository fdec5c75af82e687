"""One camera alone, the other blind: markers by their codes, ground and inclinometers besides.

The prediction serves as a start only, besides the height of the ground: what is held against it afterwards
must not have been made of it.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

from perception.geometry.pose import Prior, chi2_limit, estimate
from perception.geometry.prediction import surface_of
from perception.markers.centres import Detection
from perception.markers.circumstances import Candidates, Circumstances, brightness_misfit
from perception.markers.marker_fix import MarkerFix, Rejection, faces_cameras

LEAST_MARKERS = 3  # two in one camera fit too much
_GATE = 0.999
_MAX_TRIALS = 48
_SURFACE_ROWS = 5  # of the prior's six, those that say nothing


def choose_alone(around: Circumstances, candidates: Candidates) -> MarkerFix | Rejection:
    """The set of one camera's candidates that a pose on the ground explains; the other has none."""
    sees = [camera for camera, per_marker in enumerate(candidates) if per_marker]
    if len(sees) != 1 or around.prior is None:
        return Rejection("one camera alone and no prediction" if sees else "both cameras blind", 0)
    camera, prior = sees[0], around.prior
    name = ("left", "right")[camera]
    lit = [m for m, found in enumerate(candidates[camera]) if found]
    for count in range(len(lit), LEAST_MARKERS - 1, -1):
        fix = _best_of(around, prior, camera, candidates[camera], count)
        if fix is not None:
            return fix
    return Rejection(
        f"{name} camera alone: {len(lit)} of {around.markers} markers seen, at least {LEAST_MARKERS} needed"
        if len(lit) < LEAST_MARKERS
        else f"{name} camera alone: no pose explains {LEAST_MARKERS} or more of the {len(lit)} markers seen",
        len(lit),
    )


def _best_of(
    around: Circumstances, prior: Prior, camera: int, per_marker: Sequence[Sequence[Detection]], count: int
) -> MarkerFix | None:
    """The most likely set of so many detections that passes."""
    accepted: list[tuple[float, MarkerFix]] = []
    name = ("left", "right")[camera]
    for chosen in itertools.islice(_sets(per_marker, count), _MAX_TRIALS):
        sighting = around.sighting((camera, marker, detection) for marker, detection in chosen)
        fit = estimate(around.chain, sighting, prior.site_body, surface_of(prior))
        fit = replace(fit, dof=fit.dof - _SURFACE_ROWS)
        passes = fit.converged and fit.chi2 <= chi2_limit(fit.dof, _GATE)
        if passes and faces_cameras(around.chain, fit):
            misfit = fit.chi2 + brightness_misfit([detection.flux_counts for _, detection in chosen])
            accepted.append((misfit, MarkerFix(fit, sighting.uv_px, f"{name} camera alone")))
    return min(accepted, key=lambda a: a[0])[1] if accepted else None


def _sets(
    per_marker: Sequence[Sequence[Detection]], count: int
) -> Iterator[tuple[tuple[int, Detection], ...]]:
    """Sets of `count` detections, one a marker, the strongest first."""
    lit = [[(m, d) for d in found] for m, found in enumerate(per_marker) if found]
    sets = (
        chosen for options in itertools.combinations(lit, count) for chosen in itertools.product(*options)
    )
    yield from sorted(sets, key=lambda chosen: -math.fsum(d.snr for _, d in chosen))
