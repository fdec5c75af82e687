"""The climb to the most likely pose on image intensities, in steps by Levenberg and Marquardt."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from executive.core.types import Array
from perception.kernels.chain import STATE_SIZE, CabinChain, HeadChain, project
from perception.kernels.compiled import compiled
from perception.kernels.light import local_fits, normal_equations_with_light
from perception.kernels.linear import factor, solve
from perception.kernels.optics import Optics
from perception.kernels.readings import WeightedReadings, add_readings
from perception.kernels.rotations import moved

_MAX_STEPS = 100
_MAX_STEP_PX = 0.7
_CONVERGED_GAIN = 1e-4  # of twice the log likelihood: a hundredth of a sigma
_DIMMEST = 0.2  # of its flux is left where a step would make a marker darker than dark


class Shown(NamedTuple):
    """What the images say, as markers.likelihood.MarkerPatches has it, and how far patches `reach` [px]."""

    images: tuple[Array, Array]
    weights: tuple[Array, Array]
    corners_px: Array
    gain: Array
    box_px: float
    sigma_px: float
    reach: int


class Task(NamedTuple):
    """The rig with its markers (n, 3), readings and images, and which fluxes (n, k) change together."""

    optics: Optics
    head: HeadChain
    cabin: CabinChain
    markers_plc_m: Array
    measured: WeightedReadings
    shown: Shown
    groups: Array


class Place(NamedTuple):
    """Body in site, angles (4,) of pan, tilt, arm, cabin, and fluxes (n,) [counts]."""

    rotation: Array
    position_m: Array
    angles_rad: Array
    flux_counts: Array


class Point(NamedTuple):
    """Twice the log likelihood at a place, its gradient and information over (state, fluxes), pixels by the
    state (c, n, 2, 10), local fits, chi-square of the readings."""

    value: float
    gradient: Array
    information: Array
    by_state: Array
    local_information: Array
    local_score: Array
    local_gain: float
    readings_chi2: float


@compiled
def point_at(task: Task, place: Place) -> Point:
    """The likelihood at a place."""
    shown, n = task.shown, len(task.markers_plc_m)
    rotation, position_m, angles, flux = place
    uv, J = project(task.optics, task.head, task.cabin, task.markers_plc_m, rotation, position_m, angles)
    information, score, gain = np.empty((2, n, 3, 3)), np.empty((2, n, 3)), 0.0
    by_flux = np.empty((2, n, task.groups.shape[1]))
    for c in range(2):
        images, weights, corner = shown.images[c], shown.weights[c], shown.corners_px[c]
        light = flux * shown.gain[c]
        information[c], score[c], more = local_fits(
            images, weights, corner, uv[c], light, shown.box_px, shown.sigma_px, shown.reach
        )
        gain += more
        for m in range(n):
            for k in range(by_flux.shape[2]):
                by_flux[c, m, k] = shown.gain[c, m] * task.groups[m, k]
    H, g = normal_equations_with_light(J, by_flux, information, score)
    chi2 = add_readings(task.measured, rotation, position_m, angles, H, g)
    return Point(gain - chi2, g, H, J, information, score, gain, chi2)


@compiled
def climbed(task: Task, start: Place) -> tuple[Place, Point, int, bool]:
    """From a start to the top: there, what it is like there, steps, and whether it was reached."""
    place, at = start, point_at(task, start)
    damping, converged, steps = 1e-2, False, 0
    while steps < _MAX_STEPS and not converged:
        steps += 1
        step = _step(at, damping)
        gain_ahead = 0.0
        for s in range(len(step)):
            gain_ahead += at.gradient[s] * step[s]
        _limit(step, at.by_state)
        next_place = _stepped(task, place, step)
        there = point_at(task, next_place)
        gained = there.value - at.value
        if gained > 0:
            place, at = next_place, there
        converged = gain_ahead < _CONVERGED_GAIN
        damping = damping / 4 if gained > 0.75 * gain_ahead else max(4 * damping, 0.1)
    return place, at, steps, converged


@compiled
def _step(at: Point, damping: float) -> Array:
    damped, step = at.information.copy(), at.gradient.copy()
    for i in range(len(step)):
        damped[i, i] += damping * (damped[i, i] + 1e-12)
    factor(damped)
    solve(damped, step)
    return step


@compiled
def _limit(step: Array, by_state: Array) -> None:
    """Shorten a step by which a marker would move farther than the spread's slope reaches."""
    cameras, n = by_state.shape[:2]
    farthest = 0.0
    for c in range(cameras):
        for m in range(n):
            along_u, along_v = 0.0, 0.0
            for s in range(STATE_SIZE):
                along_u += by_state[c, m, 0, s] * step[s]
                along_v += by_state[c, m, 1, s] * step[s]
            farthest = max(farthest, math.hypot(along_u, along_v))
    if farthest > _MAX_STEP_PX:
        for s in range(len(step)):
            step[s] *= _MAX_STEP_PX / farthest


@compiled
def _stepped(task: Task, place: Place, step: Array) -> Place:
    rotation, position_m = moved(place.rotation, place.position_m, step)
    flux = place.flux_counts.copy()
    for m in range(len(flux)):
        for k in range(task.groups.shape[1]):
            flux[m] += task.groups[m, k] * step[STATE_SIZE + k]
    if min(flux) < 0 or max(flux) == 0:
        for m in range(len(flux)):
            flux[m] = max(flux[m], _DIMMEST * place.flux_counts[m])
    return Place(rotation, position_m, place.angles_rad + step[6:STATE_SIZE], flux)
