"""Bundle adjustment with scipy: least squares over the images that fit, found by turns with the solution."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from scipy.optimize import OptimizeResult, least_squares

from executive.core.one_thread import one_thread
from executive.core.rig import RigCalibration
from executive.core.types import Array
from perception.calibration.bundle import Bundle
from perception.calibration.parameters import PARAMETERS, prior_sigmas
from perception.calibration.result import Calibrated
from perception.calibration.start import first_guess
from perception.calibration.survey import Survey
from perception.calibration.target_images import Mask, TargetImages
from perception.geometry.pose import chi2_limit

_GATE = chi2_limit(2, 0.9999)  # of one image
_MEDIAN_OFF2 = 2 * math.log(2.0)  # of images that fit
_GATINGS = 20
_MOST_STEPS = 60
_ROUGHLY, _EXACTLY = 1e-4, 1e-10  # least relative gain of a step that is worth another
_REFERENCE_K = 293.0


def calibrate(
    rig: RigCalibration,
    survey: Survey,
    priors: Mapping[str, float] | None = None,
    temperature_k: float = _REFERENCE_K,
) -> Calibrated:
    """What the survey says of a rig believed to be `rig`, at `temperature_k` of the head.

    `priors` replaces prior sigmas of parameters by name. Images that fit nothing are set aside. ValueError
    says what is wrong with a survey, or that it shows nothing.
    """
    with one_thread():
        return _found(rig, survey, priors, temperature_k)


def _found(
    rig: RigCalibration, survey: Survey, priors: Mapping[str, float] | None, temperature_k: float
) -> Calibrated:
    markers, sigmas = len(rig.markers.positions_plc_m), prior_sigmas(priors)
    every = TargetImages.of(survey.checked(markers), markers)
    unknowns = first_guess(rig, survey, every, len(PARAMETERS))
    bundle = Bundle(rig, survey, every, unknowns, sigmas, temperature_k)
    done = _minimum(bundle, unknowns.start(), _ROUGHLY)
    for _ in range(_GATINGS):
        fits = _fitting(bundle, done.x)
        if (fits == bundle.sightings.seen).all():
            break
        bundle = replace(bundle, sightings=every.only(fits))
        done = _minimum(bundle, done.x, _ROUGHLY)
    return _calibrated(bundle, _minimum(bundle, done.x, _EXACTLY), every)


def _minimum(bundle: Bundle, start: Array, tolerance: float) -> OptimizeResult:
    """Dense, since the exact step needs a fifth of the iterations that LSMR's takes."""
    return least_squares(
        bundle.residuals,
        start,
        jac=bundle.dense_jacobian,
        method="trf",
        x_scale="jac",
        ftol=tolerance,
        max_nfev=_MOST_STEPS,
    )


def _fitting(bundle: Bundle, x: Array) -> Mask:
    """The images to go on with: all that fit, and of those that do not all but the worst of each target.

    A wrong image drags the others of its target along; these fit once it is set aside. What fits is judged by
    the median scatter until that is down to noise.
    """
    rows = bundle.sightings
    with np.errstate(invalid="ignore"):
        off2 = (bundle.image_residuals(x) ** 2).sum(axis=-1)
    scatter = float(np.median(off2[rows.seen])) / _MEDIAN_OFF2
    fits = np.asarray(off2 < _GATE * max(scatter, 1.0))
    suspect = np.where(rows.seen & ~fits, np.nan_to_num(off2, nan=np.inf), -1.0)
    worst = np.zeros(int(rows.target.max()) + 1)
    np.maximum.at(worst, rows.target, suspect.max(axis=0))
    return np.asarray(fits | ((suspect >= 0) & (suspect < worst[rows.target])))


def _calibrated(bundle: Bundle, done: OptimizeResult, every: TargetImages) -> Calibrated:
    k = bundle.unknowns.parameters
    J = bundle.jacobian(done.x)
    covariance = np.linalg.inv((J.T @ J).toarray())[:k, :k]
    scale = np.outer(bundle.sigmas, bundle.sigmas)
    return Calibrated(
        believed=bundle.rig,
        values=done.x[:k] * bundle.sigmas,
        covariance=(covariance + covariance.T) / 2 * scale,
        prior_sigmas=bundle.sigmas,
        temperature_k=bundle.temperature_k,
        chi2=float((bundle.residuals(done.x) ** 2).sum()),
        dof=bundle.degrees_of_freedom(),
        images=int(every.seen.sum()),
        rejected=int(every.seen.sum() - bundle.sightings.seen.sum()),
        converged=bool(done.success),
    )
