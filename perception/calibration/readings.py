"""What a calibration is told besides images: priors, encoders, inclinometers, landmarks; with derivatives."""

from __future__ import annotations

import math

import numpy as np
from scipy import sparse

from executive.core.rig import RigCalibration
from executive.core.types import Array
from perception.calibration.survey import Station, Survey
from perception.calibration.unknowns import Unknowns, turn_rate
from perception.geometry.pose import roll_pitch
from perception.geometry.rotation import rot_y

_POINT_SIGMA = np.array([1.0, 1.0, 0.5])  # of bearing and inverse distance: only so that nothing is singular
_POINT_MEAN = np.array([0.0, 0.0, 0.1])


def readings(
    rig: RigCalibration, survey: Survey, names: tuple[str, ...], unknowns: Unknowns, x: Array
) -> tuple[Array, sparse.csr_matrix]:
    """Residuals in sigmas at `x`, and their derivatives by it."""
    priors = unknowns.first_station  # parameters and pointing errors are themselves residuals
    off, J = [x[:priors]], [sparse.eye(priors, unknowns.size, format="csr")]
    for s, station in enumerate(survey.stations):
        residual, by_turn = _inclinometers(rig, station, unknowns, x, s)
        off.append(residual)
        J.append(_block(by_turn, unknowns.first_station + 6 * s + 3, unknowns.size))
    for p, name in enumerate(names):
        residual, by_point = _point(survey, name, unknowns, x, p)
        off.append(residual)
        J.append(_block(by_point, unknowns.first_point + 3 * p, unknowns.size))
    return np.concatenate(off), sparse.csr_matrix(sparse.vstack(J))


def _inclinometers(
    rig: RigCalibration, station: Station, unknowns: Unknowns, x: Array, index: int
) -> tuple[Array, Array]:
    """Roll and pitch of the body under the plate, and their derivative (2, 3) by the step's rotation.

    The cabin joint turns the plate about the axis of pitch, so its error is one of pitch.
    """
    tilt_sigma, joint_sigma = rig.rover.inclinometer_sigma_rad, rig.cabin.joint_sigma_rad
    sigma = np.maximum([tilt_sigma, math.hypot(tilt_sigma, joint_sigma)], 1e-7)
    angles, by_turn = roll_pitch(unknowns.station(x, index).rotation @ rot_y(station.joints_rad[1]))
    rate = turn_rate(unknowns.station_step(x, index)[3:])
    return (angles - np.array(station.tilt_rad)) / sigma, by_turn @ rate / sigma[:, None]


def _point(survey: Survey, name: str, unknowns: Unknowns, x: Array, index: int) -> tuple[Array, Array]:
    """A landmark's place, or next to nothing for any other point."""
    landmark = survey.landmarks.get(name)
    if landmark is None:
        first = unknowns.first_point + 3 * index
        return (x[first : first + 3] - _POINT_MEAN) / _POINT_SIGMA, np.diag(1 / _POINT_SIGMA)
    whiten = np.linalg.inv(np.linalg.cholesky(landmark.covariance))
    position, by_point = unknowns.point(x, index)
    return whiten @ (position - landmark.position_site_m), whiten @ by_point


def _block(values: Array, first: int, size: int) -> sparse.csr_matrix:
    """A block of rows whose columns begin at `first`."""
    rows, width = values.shape
    at, where = np.divmod(np.arange(rows * width), width)
    return sparse.csr_matrix((values.ravel(), (at, first + where)), shape=(rows, size))
