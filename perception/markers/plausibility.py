"""Which candidates are the markers? The set that one rigid pose explains.

For each LED any pair of a left and a right candidate that meets in space is a hypothesis; so is "not seen".
Sets of hypotheses are tried from the fullest down; one is accepted when the distances between its points
are those of the marker plate and the residuals of its pose pass the chi-square gate; among equally full
sets the most likely wins, evenness of brightness included. Two markers make a pose only where no third is
seen: any two of a plate whose LEDs are mixed up fit a rover that stands elsewhere.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from executive.core.types import Array, Vec2
from perception.geometry.body import Transform, points_in_body
from perception.geometry.camera import triangulate
from perception.geometry.chain import Chain, ChainState
from perception.geometry.pose import (
    Prior,
    Sighting,
    chi2_limit,
    estimate,
    guess_body,
)
from perception.geometry.prediction import Expectation
from perception.geometry.rotation import (
    nearest_rotation,
    rot_x,
    rot_y,
    rot_z,
)
from perception.markers.centres import Detection
from perception.markers.circumstances import Candidates, Circumstances, brightness_misfit
from perception.markers.identity import exchanges
from perception.markers.marker_fix import MarkerFix, Rejection, faces_cameras
from perception.markers.monocular import choose_alone

_GATE = 0.999
_WIDE_GATE_SIGMAS = 4.0  # for the quick tests that only prune
_BRIGHTNESS_RATIO = 2.5  # between the two cameras, which see a marker from almost the same side
_MAX_TRIALS = 48
_LEAST_MARKERS = 2
_OF_MORE = 3  # the least that must fit where more are seen
_LEAD = 16.0  # by how many squared sigmas of the prediction one way of swapping must be nearer than another


@dataclass(frozen=True, eq=False)
class StereoPoint:
    """One LED hypothesis: a left and a right detection, their point in `ih` with covariance (3, 3)."""

    marker: int
    left: Detection
    right: Detection
    point_ih_m: Array
    covariance: Array

    @property
    def snr(self) -> float:
        return float(np.hypot(self.left.snr, self.right.snr))


def choose(
    chain: Chain,
    candidates: Candidates,
    head_rad: Vec2,
    joints_rad: Vec2,
    tilt_rad: Vec2 | None,
    prior: Prior | None = None,
) -> MarkerFix | Rejection:
    """The jointly consistent set of candidates and the pose it gives, or why there is none.

    `prior` starts the search for an attitude and is used as a measurement where fewer than four markers
    are seen. An empty list for a camera says that it is blind: the other one's candidates are then all.
    """
    around = Circumstances(chain, head_rad, joints_rad, tilt_rad, prior)
    if not all(candidates):
        return choose_alone(around, candidates)
    found = _as_labelled(around, candidates)
    if isinstance(found, Rejection) and found.seen == around.markers:
        return _swapped(around, candidates) or found
    return found


def _as_labelled(around: Circumstances, candidates: Candidates) -> MarkerFix | Rejection:
    """The best set, each LED taken for the marker that it should be."""
    pairs = _pairs(around, candidates)
    seen = sum(bool(p) for p in pairs)
    if seen < _LEAST_MARKERS:
        return Rejection(f"{seen} of {around.markers} markers seen by both cameras, at least 2 needed", seen)
    least = min(seen, _OF_MORE)
    for count in range(seen, least - 1, -1):
        fix = _best_of(around, pairs, count)
        if fix is not None:
            return fix
    return Rejection(f"no pose explains {least} or more of the {seen} markers seen", seen)


def _swapped(around: Circumstances, candidates: Candidates) -> MarkerFix | None:
    """A pose of all markers with one or two couples of LEDs exchanged, if just one is near the prediction."""
    if around.prior is None:
        return None
    found: list[tuple[float, MarkerFix]] = []
    expected = ChainState(around.prior.site_body, around.head_rad, around.joints_rad)
    for order, said in exchanges(around.markers):
        pairs = _pairs(around, [[camera[m] for m in order] for camera in candidates])
        fix = _best_of(around, pairs, around.markers)
        if fix is not None:
            distance2 = Expectation(expected, around.prior.covariance).distance2(fix.fit.state.site_body)
            found.append((distance2, replace(fix, note=said)))
    found.sort(key=lambda f: f[0])
    alone = len(found) == 1 or (len(found) > 1 and found[1][0] - found[0][0] > _LEAD)
    return found[0][1] if alone else None


def _pairs(around: Circumstances, candidates: Candidates) -> list[list[StereoPoint]]:
    left, right = candidates
    return [_stereo_points(around.chain, m, left[m], right[m]) for m in range(around.markers)]


def _best_of(around: Circumstances, pairs: Sequence[Sequence[StereoPoint]], count: int) -> MarkerFix | None:
    """The most likely set of so many points that passes."""
    accepted: list[tuple[float, MarkerFix]] = []
    for points in itertools.islice(_rigid_sets(around.chain, pairs, count), _MAX_TRIALS):
        fix = _fix_of(around, points)
        if fix is not None:
            flux = [p.left.flux_counts + p.right.flux_counts for p in points]
            accepted.append((fix.fit.chi2 + brightness_misfit(flux), fix))
    return min(accepted, key=lambda a: a[0])[1] if accepted else None


def _stereo_points(
    chain: Chain, marker: int, left: Sequence[Detection], right: Sequence[Detection]
) -> list[StereoPoint]:
    """Pairs that meet in space in front of the cameras and look equally bright, the strongest first."""
    found = []
    for a, b in itertools.product(left, right):
        point = _meet(chain, marker, a, b)
        if point is not None and max(a.flux_counts, b.flux_counts) < _BRIGHTNESS_RATIO * min(
            a.flux_counts + 2 * a.flux_sigma_counts, b.flux_counts + 2 * b.flux_sigma_counts
        ):
            found.append(point)
    return sorted(found, key=lambda p: -p.snr)


def _meet(chain: Chain, marker: int, left: Detection, right: Detection) -> StereoPoint | None:
    """The point of two detections, if their epipolar misfit is within noise."""
    uv = np.stack([left.uv_px, right.uv_px])[:, None]
    point = triangulate(chain.model, uv)
    if not np.isfinite(point).all():
        return None
    seen, J = chain.model.project_with_jacobian(point)
    off = uv - seen
    if not np.isfinite(off).all():
        return None
    # One weighted step from the midpoint of the rays to the most likely point.
    W = np.linalg.inv(np.stack([left.covariance_px2, right.covariance_px2]))
    H = np.einsum("cki,ckl,clj->ij", J[:, 0], W, J[:, 0])
    covariance = np.linalg.inv(H)
    step = covariance @ np.einsum("cki,ckl,cl->i", J[:, 0], W, off[:, 0])
    rest = off[:, 0] - J[:, 0] @ step
    misfit = float(np.einsum("ck,ckl,cl->", rest, W, rest))
    if misfit > _WIDE_GATE_SIGMAS**2:
        return None
    return StereoPoint(marker, left, right, point[0] + step, covariance)


def _rigid_sets(
    chain: Chain, pairs: Sequence[Sequence[StereoPoint]], count: int
) -> Iterator[tuple[StereoPoint, ...]]:
    """Sets of `count` points, one a marker, at the distances of the plate; strongest first."""
    led = [m for m, options in enumerate(pairs) if options]
    sets = (
        points
        for chosen in itertools.combinations(led, count)
        for points in itertools.product(*(pairs[m] for m in chosen))
    )
    rigid = (points for points in sets if _distances_fit(chain, points))
    yield from sorted(rigid, key=lambda points: -sum(p.snr for p in points))


def _distances_fit(chain: Chain, points: Sequence[StereoPoint]) -> bool:
    for a, b in itertools.combinations(points, 2):
        true = float(np.linalg.norm(chain.markers_plc_m[a.marker] - chain.markers_plc_m[b.marker]))
        gap = a.point_ih_m - b.point_ih_m
        length = float(np.linalg.norm(gap))
        along = gap / max(length, 1e-9)
        variance = along @ (a.covariance + b.covariance) @ along
        across = (np.trace(a.covariance + b.covariance) - variance) / max(length, 0.03)  # second order
        if abs(length - true) > _WIDE_GATE_SIGMAS * np.sqrt(variance) + across:
            return False
    return True


def _fix_of(around: Circumstances, points: Sequence[StereoPoint]) -> MarkerFix | None:
    """The set's pose, if its residuals pass."""
    chain, prior = around.chain, around.prior
    sighting = around.sighting(
        (camera, p.marker, detection) for p in points for camera, detection in enumerate((p.left, p.right))
    )
    measured_prior = None if len(points) == around.markers else prior
    if len(points) < 3 and prior is None and around.tilt_rad is None:
        return None
    for start in _starts(chain, points, sighting, prior):
        fit = estimate(chain, sighting, start, measured_prior)
        if fit.chi2 <= chi2_limit(fit.dof, _GATE) and fit.converged and faces_cameras(chain, fit):
            return MarkerFix(fit, sighting.uv_px)
    return None


def _starts(
    chain: Chain, points: Sequence[StereoPoint], sighting: Sighting, prior: Prior | None
) -> Iterator[Transform]:
    """Starts for the iteration: the linear guess where three markers allow it, then upright attitudes."""
    in_ih = np.stack([p.point_ih_m for p in points])
    markers = [p.marker for p in points]
    if len(points) >= 3:
        yield guess_body(chain, in_ih, sighting, markers)
    yield _upright_guess(chain, in_ih, sighting, markers, prior)


def _upright_guess(
    chain: Chain, points_ih_m: Array, sighting: Sighting, markers: list[int], prior: Prior | None
) -> Transform:
    """Heading and place that best carry the markers onto the points (Procrustes in the horizontal),
    with the roll and pitch of the prediction or of the inclinometers."""
    site = chain.site_ih(sighting.head_rad).apply(points_ih_m)
    in_body = points_in_body(chain.rig.cabin, chain.markers_plc_m[markers], *sighting.joints_rad)[0]
    if sighting.tilt_rad is not None:
        roll, pitch = sighting.tilt_rad
        level = rot_y(pitch) @ rot_x(roll)
    elif prior is not None:
        level = prior.site_body.rotation
    else:
        level = np.eye(3)
    model = in_body @ level.T
    M = (site - site.mean(axis=0))[:, :2].T @ (model - model.mean(axis=0))[:, :2]
    heading = float(np.arctan2(M[1, 0] - M[0, 1], M[0, 0] + M[1, 1]))
    rotation = nearest_rotation(rot_z(heading) @ level)
    return Transform(rotation, (site - in_body @ rotation.T).mean(axis=0))
