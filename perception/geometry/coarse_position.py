"""Where a point is, from its pixels in one camera or both and the height that it is thought to have."""

from __future__ import annotations

import numpy as np

from executive.core.types import Array
from perception.geometry.camera import StereoModel
from perception.geometry.checks import as_finite

_STEPS = 5
_CONVERGED_M = 1e-5


def coarse_position(
    model: StereoModel, uv_px: Array, sigma_px: Array, height_ih: tuple[Array, float, float]
) -> tuple[Array, Array]:
    """A point (3,) in `ih` and its covariance from pixels (2, 2) with sigmas (2,), and a known height.

    `height_ih` is the plane the point lies on as (unit normal in ih, offset along it [m], sigma [m]).
    A camera that saw nothing is NaN; one is enough. ValueError if neither saw anything.
    """
    normal, offset, sigma_height = as_finite("normal", height_ih[0], (3,)), height_ih[1], height_ih[2]
    seen = np.isfinite(uv_px).all(axis=1)
    if not seen.any():
        raise ValueError("uv_px: got NaN for both cameras, expected at least one to see the rover")
    rays = model.rays_ih(uv_px[:, None])[:, 0]
    centre, ray = model.position_ih_m[seen][0], rays[seen][0]
    point = centre + ray * (offset - normal @ centre) / (normal @ ray)
    H = np.eye(3)
    for _ in range(_STEPS):
        uv, J = model.project_with_jacobian(point[None])
        w = sigma_px[seen] ** -2.0
        A, off = J[seen, 0], (uv_px - uv[:, 0])[seen]
        H = np.einsum("cki,c,ckj->ij", A, w, A) + np.outer(normal, normal) / sigma_height**2
        g = np.einsum("cki,c,ck->i", A, w, off) + normal * (offset - normal @ point) / sigma_height**2
        step = np.linalg.solve(H, g)
        point = point + step
        if np.abs(step).max() < _CONVERGED_M:
            break
    return point, np.asarray(np.linalg.inv(H), dtype=np.float64)
