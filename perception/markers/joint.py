"""Joint detection: all markers in both cameras as one pose on the ground, for light too faint to see singly.

Coarse search (perception.markers.search), then the most likely pose from each of the best places
(markers.likelihood). A pose is accepted when its joint SNR exceeds what noise alone shows anywhere in the
region at the false-alarm rate, when nothing else explains the images as well, and when what the images say
at each marker agrees with it. Where not all markers shine as they should, LEDs may be mixed up: that is
tried too.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from executive.core.types import Array, Vec2
from perception.frames.difference import Difference
from perception.frames.psf import Spread
from perception.geometry.chain import Chain, ChainState
from perception.geometry.pose import PoseFit, PoseReadings, chi2_limit
from perception.geometry.prediction import Expectation
from perception.geometry.rotation import log_map
from perception.markers.identity import exchanges
from perception.markers.joint_search import (
    JointScene,
    Searchable,
    alike,
    sighting_without_centres,
)
from perception.markers.likelihood import Likely, MarkerPatches, most_likely
from perception.markers.marker_fix import (
    MarkerFix,
    Rejection,
    faces_cameras,
    with_note,
)
from perception.markers.posterior import posterior

# Of the whole region: a third of the 1e-3 that is claimed. The threshold keeps its theory's leading term only
# and on 1200 regions of white noise 1.0 to 2.7 times as many climbed as high as it says.
FALSE_ALARM_RATE = 3e-4
_GATE = 0.9999
_EVEN_GATE = 0.99  # beyond it the markers are not taken to shine alike
_FEW_GATE = 0.99  # where two markers must do
_RIVAL = 6.0  # twice the difference in log likelihood below which another pose explains the images as well
_DARK_RIVAL = 3.0  # the same where that pose needs LEDs to be dark, which they seldom are
_LEAST_MARKER_SNR = 2.5  # of one marker in both cameras, to count as shining once the pose is known
_LEAST_MARKERS = 2
_LEAST_SNR_ALONE = 7.0  # of one camera: with less, heading and range are bent more than a covariance can say
_AS_EXPECTED = 0.75  # of the joint SNR expected: a pose with less leaves light unexplained, or LEDs are dim
_GLOW = 0.35  # of the brightest marker's flux: less may be an LED that is dim, or none
_AS_BRIGHT = 0.6  # of it: less may be another's light, grazed
_NOISE_RATE = 0.05  # of noise alone, in the search for what the markers that do not shine at a pose may show
_ELSEWHERE_SIGMAS = 3.5  # of x, y or heading
_PLANAR = [0, 1, 5]
_SURE = 3.0  # above that, the joint SNR at which markers as bright would hardly stay below it


def joint_fix(
    chain: Chain,
    cameras: Sequence[Difference | None],
    corners_px: Sequence[tuple[int, int]],
    spread: Spread,
    expectation: Expectation,
    tilt_rad: Vec2,
    widen: float = 1.0,
) -> MarkerFix | Rejection:
    """The one pose in the expectation's region that the difference images show, or why there is none.

    A blind camera is None: the pose then comes from the other alone, and asks for three markers.
    """
    seeing = [camera for camera, one in enumerate(cameras) if one is not None]
    images = [_nothing(len(chain.markers_plc_m)) if one is None else one for one in cameras]
    readings = PoseReadings.of(
        chain, sighting_without_centres(chain, expectation, tilt_rad), expectation.surface
    )
    scene = JointScene(chain, corners_px, spread, expectation, readings, widen, seeing)
    shown = scene.prepared(images)
    found = _find(scene, shown)
    if isinstance(found, Rejection):
        return found
    if found.bright.all() and found.best.snr > _AS_EXPECTED * scene.expected_snr(shown):
        return _gated(scene, found)
    swapped, said = _exchanged(scene, shown, found)
    if swapped is not None:
        return with_note(_gated(scene, swapped), said)
    lack = _too_few(scene, shown, found) or _otherwise(scene, shown, found)
    return Rejection(lack, found.shining) if lack else _gated(scene, found)


@dataclass(frozen=True, eq=False)
class _Found:
    """The best pose of a search: `lead` is how much more likely it is than any other, twice the logarithm;
    `threshold` the joint SNR that it passed, `shared` whether all markers have one flux."""

    best: Likely
    shared: bool
    lead: float
    threshold: float
    patches: MarkerPatches

    @property
    def shining(self) -> int:
        return int((self.best.flux_counts > 0).sum())

    @property
    def bright(self) -> NDArray[np.bool_]:
        """Which markers (n,) are beyond doubt."""
        flux = self.best.flux_counts
        bright: NDArray[np.bool_] = flux > _GLOW * flux.max()
        return bright


def _find(scene: JointScene, images: Searchable) -> _Found | Rejection:
    """The pose that the images show most clearly, if more clearly than noise would."""
    likely = scene.climbed(images)
    threshold = scene.threshold(FALSE_ALARM_RATE)
    if len(scene.seeing) < 2:
        threshold = max(threshold, _LEAST_SNR_ALONE)
    shown = [one for one in likely if one.snr >= threshold]
    if not shown:
        strongest = max((one.snr for one in likely), default=0.0)
        return Rejection(f"joint SNR {strongest:.1f} of all markers, {threshold:.1f} needed", 0)
    nearest = max(shown, key=lambda one: _worth(scene.expectation, one))
    rivals = [_worth(scene.expectation, one) for one in likely if one is not nearest]
    lead = _worth(scene.expectation, nearest) - max(rivals, default=-math.inf)
    best, shared = _with_own_fluxes(scene.chain, images.patches, scene.readings, nearest)
    return _Found(best, shared, lead, threshold, images.patches)


def _exchanged(scene: JointScene, images: Searchable, found: _Found) -> tuple[_Found | None, str]:
    """A pose at which all markers shine once one or two couples of LEDs are exchanged, if that explains the
    images better, and which couples these are."""
    better: tuple[_Found | None, str] = None, ""
    flux = found.best.flux_counts
    sure = (flux > _AS_BRIGHT * flux.max()) & ~found.bright.all()
    least = found.best.snr**2 + _RIVAL
    for order, said in exchanges(len(found.bright)):
        moved = [(m, at) for m, at in enumerate(order) if m != at]
        if any(sure[m] and sure[at] for m, at in moved):
            continue
        other = _find(scene, images.exchanged(order))
        if isinstance(other, _Found) and other.bright.all() and other.best.snr**2 > least:
            better, least = (other, said), other.best.snr**2
    return better


def _too_few(scene: JointScene, images: Searchable, found: _Found) -> str:
    """Why the markers that shine at the best pose are too few for it; empty if they are not.

    Any two of a plate whose LEDs are mixed up fit a rover that stands elsewhere, and a third may seem to glow
    there. So two must be strong enough that others as bright would show, and the others must shine nowhere
    else.
    """
    bright, best = found.bright, found.best
    said = f"{int(bright.sum())} of {len(bright)} markers shine at the best pose"
    if bright.sum() > _LEAST_MARKERS:
        return ""
    if bright.sum() < _LEAST_MARKERS or len(scene.seeing) < 2:
        return said
    noise = scene.threshold(_NOISE_RATE)
    if best.snr < noise + _SURE:
        return f"{said}, joint SNR {best.snr:.1f}, {noise + _SURE:.1f} needed for so few"
    others = scene.climbed(images, ~bright)
    elsewhere = any(one.snr > noise and not alike(scene.chain, one, best) for one in others)
    return f"{said}, and the others elsewhere" if elsewhere else ""


def _otherwise(scene: JointScene, images: Searchable, found: _Found) -> str:
    """Where else a rover with one or two LEDs dark explains the images about as well; empty if nowhere."""
    worth, everyone = _worth(scene.expectation, found.best), range(len(found.bright))
    for count in range(_LEAST_MARKERS, len(found.bright)):
        for shining in itertools.combinations(everyone, count):
            mask = np.isin(everyone, shining)
            for one in scene.climbed(images, mask):
                lead = worth - _worth(scene.expectation, one)
                if lead < _DARK_RIVAL and _contradict(found.best, one):
                    said = f"one with {count} of {len(mask)} markers, {lead:.1f} apart in log likelihood"
                    return f"two poses explain the images, {said}"
    return ""


def _contradict(best: Likely, other: Likely) -> bool:
    """Whether another pose lies where the best one does not allow it."""
    here, there = best.state.site_body, other.state.site_body
    turn = log_map(there.rotation @ here.rotation.T)
    off = np.concatenate([there.position_m - here.position_m, turn])[_PLANAR]
    return bool((np.abs(off) > _ELSEWHERE_SIGMAS * np.sqrt(np.diag(best.covariance)[_PLANAR])).any())


def _nothing(markers: int) -> Difference:
    """What a blind camera says."""
    blank = np.zeros((markers, 1, 1), np.float32)
    return Difference(blank, np.full_like(blank, np.inf), blank[0], 0)


def _with_own_fluxes(
    chain: Chain, patches: MarkerPatches, readings: PoseReadings, best: Likely
) -> tuple[Likely, bool]:
    """The pose again with a flux for each marker, where one for all does not fit; dark ones drop out."""
    information = best.local.information[..., 0, 0] * patches.gain**2
    pull = best.local.score[..., 0] * patches.gain
    total = np.maximum(information.sum(axis=0), 1e-30)
    change, sigma = pull.sum(axis=0) / total, 1 / np.sqrt(total)
    if float(((change / sigma) ** 2).sum()) <= chi2_limit(len(change) - 1, _EVEN_GATE):
        return best, True
    own = best.flux_counts + change
    own = np.where(own > _LEAST_MARKER_SNR * sigma, own, 0.0)
    if np.count_nonzero(own) < _LEAST_MARKERS:
        return replace(best, flux_counts=own), False
    again = most_likely(chain, patches, readings, best.state, own, shared=False)
    return (best, True) if again is None else (again, False)


def _worth(expectation: Expectation, one: Likely) -> float:
    """Twice the log of likelihood times prediction: of poses equally likely by the images, the nearer one."""
    return one.snr**2 - expectation.distance2(one.state.site_body)


def _gated(scene: JointScene, found: _Found) -> MarkerFix | Rejection:
    """The pose as a fix, unless the images contradict it or something else explains them as well."""
    best = found.best
    alive = best.flux_counts > 0
    gate = _GATE if found.bright.sum() > _LEAST_MARKERS else _FEW_GATE
    fit = _fit_of(scene, best, alive)
    seen = int(alive.sum())
    if not best.converged:
        return Rejection(f"no best pose after {best.steps} steps", seen)
    if fit.chi2 > chi2_limit(fit.dof, gate):
        return Rejection(f"the images pull the markers apart: chi-square {fit.chi2:.0f} of {fit.dof}", seen)
    if uneven := _unevenness(found):
        return Rejection(uneven, seen)
    if found.lead < _RIVAL:
        return Rejection(f"two poses explain the images, {found.lead:.1f} apart in log likelihood", seen)
    if not faces_cameras(scene.chain, fit):
        return Rejection("the markers would show their backs", seen)
    note = f"joint SNR {best.snr:.1f}, {found.threshold:.1f} needed"
    detected_px = fit.reprojected_px + fit.residual_px
    state, covariance = posterior(scene.chain, found.patches, scene.readings, best, found.shared)
    return MarkerFix(_moved(scene.chain, fit, detected_px, state, covariance), detected_px, note)


def _moved(chain: Chain, fit: PoseFit, detected_px: Array, state: ChainState, covariance: Array) -> PoseFit:
    """The same fit at the mean of what the images allow instead of at the peak."""
    uv, _ = chain.project(state)
    residual = np.where(np.isfinite(detected_px), detected_px - uv, np.nan)
    return replace(fit, state=state, covariance=covariance, reprojected_px=uv, residual_px=residual)


def _unevenness(found: _Found) -> str:
    """Why the light does not come from markers that both cameras see; empty if it does."""
    best, alive = found.best, found.best.flux_counts > 0
    information, score = best.local.information[:, alive, 0, 0], best.local.score[:, alive, 0]
    seen = information > 0
    chi2 = float((score[seen] ** 2 / information[seen]).sum())
    dof = int(seen.sum()) - (1 if found.shared else found.shining)
    if chi2 <= chi2_limit(dof, _GATE):
        return ""
    return f"the markers do not shine alike in both cameras: chi-square {chi2:.0f} of {dof}"


def _fit_of(scene: JointScene, best: Likely, alive: NDArray[np.bool_]) -> PoseFit:
    """The pose as a fit, its residuals those of the centres that the images alone would have.

    Chi-square is that of the likelihood's score at the pose, which is exact also where a single centre is
    far too faint to be a measurement of its own.
    """
    uv, _ = scene.chain.project(best.state)
    used = np.ix_(np.array(scene.seeing), np.flatnonzero(alive))
    information, score = best.local.information[used][..., 1:, 1:], best.local.score[used][..., 1:]
    pull = np.linalg.solve(information + 1e-12 * np.eye(2), score[..., None])[..., 0]
    residual = np.full_like(uv, np.nan)
    residual[used] = pull
    chi2 = float((pull * score).sum()) + best.readings_chi2
    readings = 4 + 2 + 1  # encoders, inclinometers, the surface
    dof = score.size + readings - 10
    return PoseFit(best.state, best.covariance, chi2, dof, uv, residual, best.steps, best.converged)
