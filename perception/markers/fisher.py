"""The Cramer-Rao bound: how well centres and poses can be known from given images, by any method."""

from __future__ import annotations

import math

import numpy as np

from executive.core.types import Array
from perception.frames.exposure import flux_expected, plate_view
from perception.frames.psf import Spread, marker_spread
from perception.geometry.chain import STATE_SIZE, Chain, ChainState
from perception.geometry.pose import roll_pitch

_ON_SURFACE = [0, 1, 5]  # x, y, yaw


def centre_bound(spread: Spread, flux_counts: float, sigma_counts: float, offset_px: Array) -> Array:
    """Least covariance (2, 2) [px2] of a centre at `offset_px` (2,) from a pixel, flux unknown.

    For a difference image with white noise `sigma_counts`; formal below a filter SNR of about 4.
    """
    reach = spread.radius_px + 2
    grid = np.arange(-reach, reach + 1.0)
    u, v = grid - offset_px[0], grid - offset_px[1]
    pu, pv = spread.profile(u), spread.profile(v)
    J = np.stack(
        [
            np.outer(pv, pu),
            -flux_counts * np.outer(pv, spread.profile_slope(u)),
            -flux_counts * np.outer(spread.profile_slope(v), pu),
        ]
    ).reshape(3, -1)
    information = J @ J.T / sigma_counts**2
    return np.asarray(np.linalg.inv(information)[1:, 1:], dtype=np.float64)


def centre_bounds(chain: Chain, state: ChainState, pairs: float) -> Array:
    """Least covariances (2, n, 2, 2) [px2] of all centres after `pairs` on/off pairs of each marker.

    For the rig's own sensor noise and marker power, and the range and angle at which the state shows them.
    """
    view = plate_view(chain, state)
    spread, flux = marker_spread(chain.rig, view.range_m), flux_expected(chain.rig, view)
    noise = chain.rig.sensor.noise_counts * math.sqrt(2.0 / pairs)
    uv, _ = chain.project(state)
    bounds = [[centre_bound(spread, flux, noise, c - np.round(c)) for c in camera] for camera in uv]
    return np.array(bounds)


def pose_bound(
    chain: Chain,
    state: ChainState,
    centre_covariance_px2: Array,
    with_tilt: bool = True,
    exact_head: bool = False,
    height_sigma_m: float = math.inf,
) -> Array:
    """Least covariance (6, 6) of the body pose at a true state, from centres with covariance (2, n, 2, 2).

    NaN covariances stand for markers not seen. `with_tilt` adds the inclinometers, `height_sigma_m` a ground
    known so well; `exact_head` takes the head and joint angles for perfectly known.
    """
    _, J = chain.project(state)
    seen = np.isfinite(centre_covariance_px2).all(axis=(-1, -2))
    J, W = J[seen], np.linalg.inv(centre_covariance_px2[seen])
    information = np.einsum("mik,mij,mjl->kl", J, W, J)
    weight = np.full(4, 1e14) if exact_head else chain.encoder_sigma_rad() ** -2
    information[range(6, STATE_SIZE), range(6, STATE_SIZE)] += weight
    information[2, 2] += height_sigma_m**-2
    if with_tilt:
        _, by_turn = roll_pitch(state.site_body.rotation)
        information[3:6, 3:6] += by_turn.T @ by_turn / chain.rig.rover.inclinometer_sigma_rad**2
    return np.asarray(np.linalg.inv(information)[:6, :6], dtype=np.float64)


def surface_bound(chain: Chain, state: ChainState, pairs: float, height_sigma_m: float) -> Array:
    """Least covariance (3, 3) of x, y [m] and yaw [rad] of a rover on a surface known to `height_sigma_m`."""
    bound = pose_bound(chain, state, centre_bounds(chain, state, pairs), height_sigma_m=height_sigma_m)
    return bound[np.ix_(_ON_SURFACE, _ON_SURFACE)]
