"""Log likelihoods of many poses, given the difference images of all markers."""

from __future__ import annotations

import numpy as np

from executive.core.types import Array
from perception.kernels.chain import STATE_SIZE, project
from perception.kernels.climb import Place, Task
from perception.kernels.compiled import compiled
from perception.kernels.light import local_fits
from perception.kernels.readings import add_readings
from perception.kernels.rotations import moved


@compiled
def log_likelihoods(task: Task, place: Place, steps: Array) -> Array:
    """Log likelihoods (k,) of a state moved by steps (k, 10), each with the fluxes that fit it best."""
    log_likelihood = np.empty(len(steps))
    for k in range(len(steps)):
        rotation, position_m = moved(place.rotation, place.position_m, steps[k])
        angles_rad = place.angles_rad + steps[k, 6:]
        H, g = np.zeros((STATE_SIZE, STATE_SIZE)), np.zeros(STATE_SIZE)
        chi2 = add_readings(task.measured, rotation, position_m, angles_rad, H, g)
        log_likelihood[k] = (_light(task, rotation, position_m, angles_rad) - chi2) / 2
    return log_likelihood


@compiled
def _light(task: Task, rotation: Array, position_m: Array, angles_rad: Array) -> float:
    """Squared joint SNR of the markers at a pose."""
    shown, groups, dark = task.shown, task.groups, np.zeros(len(task.markers_plc_m))
    uv, _ = project(task.optics, task.head, task.cabin, task.markers_plc_m, rotation, position_m, angles_rad)
    power, pull, light = np.zeros(groups.shape[1]), np.zeros(groups.shape[1]), 0.0
    for c in range(2):
        images, weights, corner = shown.images[c], shown.weights[c], shown.corners_px[c]
        information, score, _ = local_fits(
            images, weights, corner, uv[c], dark, shown.box_px, shown.sigma_px, shown.reach
        )
        for m in range(len(dark)):
            for f in range(len(power)):
                power[f] += groups[m, f] * shown.gain[c, m] ** 2 * information[m, 0, 0]
                pull[f] += groups[m, f] * shown.gain[c, m] * score[m, 0]
    for f in range(len(power)):
        if pull[f] > 0.0 and power[f] > 0.0:
            light += pull[f] * pull[f] / power[f]
    return light
