"""Log likelihoods of many poses, given the difference images of all markers."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from executive.types import Array
from perception.kernels.chain import STATE_SIZE, Cabin, Head, project
from perception.kernels.compiled import compiled
from perception.kernels.gauss_newton import stepped
from perception.kernels.light import local_fits
from perception.kernels.optics import Optics
from perception.kernels.readings import Measured, add_readings


class Seen(NamedTuple):
    """One camera's difference images and inverse variances (n, h, w) [counts], the full-frame place (2,) of
    their first pixel, and each marker's expected brightness (n,) relative to the others'."""

    images: Array
    weights: Array
    corner_px: Array
    gain: Array


class Light(NamedTuple):
    """A blurred square of light, and how far from its middle pixels are looked at."""

    box_px: float
    sigma_px: float
    reach: int


@compiled
def log_likelihoods(
    optics: Optics,
    head: Head,
    cabin: Cabin,
    markers_plc_m: Array,
    measured: Measured,
    left: Seen,
    right: Seen,
    light: Light,
    groups: Array,
    rotation: Array,
    position_m: Array,
    angles_rad: Array,
    steps: Array,
) -> Array:
    """Log likelihoods (k,) of a state moved by steps (k, 10), each with the fluxes that fit it best.

    `groups` (n, fluxes) says which markers share a flux; one in no group is dark.
    """
    log_likelihood, dark = np.empty(len(steps)), np.zeros(len(markers_plc_m))
    for k in range(len(steps)):
        turned, moved, aimed = stepped(rotation, position_m, angles_rad, steps[k])
        uv, _ = project(optics, head, cabin, markers_plc_m, turned, moved, aimed)
        power, pull = np.zeros(groups.shape[1]), np.zeros(groups.shape[1])
        for c in range(2):
            seen = left if c == 0 else right
            of_camera = seen.images, seen.weights, seen.corner_px
            information, score, _ = local_fits(
                *of_camera, uv[c], dark, light.box_px, light.sigma_px, light.reach
            )
            for m in range(len(dark)):
                for f in range(len(power)):
                    power[f] += groups[m, f] * seen.gain[m] ** 2 * information[m, 0, 0]
                    pull[f] += groups[m, f] * seen.gain[m] * score[m, 0]
        H, g = np.zeros((STATE_SIZE, STATE_SIZE)), np.zeros(STATE_SIZE)
        twice = -add_readings(measured, turned, moved, aimed, H, g)
        for f in range(len(power)):
            if pull[f] > 0.0 and power[f] > 0.0:
                twice += pull[f] * pull[f] / power[f]
        log_likelihood[k] = twice / 2
    return log_likelihood
