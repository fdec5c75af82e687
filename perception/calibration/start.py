"""First guesses of where rover and points were, by triangulation with the rig as it was believed to be."""

from __future__ import annotations

import numpy as np

from executive.core.rig import RigCalibration
from executive.core.types import Array
from perception.calibration.survey import FARTHEST_M, NEAREST_M, Survey
from perception.calibration.target_images import Mask, TargetImages
from perception.calibration.unknowns import Bearing, Unknowns
from perception.geometry.body import Transform
from perception.geometry.camera import triangulate
from perception.geometry.chain import Chain
from perception.geometry.pose import linear_guess

_DISTANCE_M = 10.0  # of a point that no pair of images gives a distance


def first_guess(rig: RigCalibration, survey: Survey, sightings: TargetImages, parameters: int) -> Unknowns:
    """Where the solution starts; ValueError for a station that no look shows well enough."""
    chain = Chain.of(rig)
    stations = tuple(_station(chain, survey, index) for index in range(len(survey.stations)))
    known = len(survey.stations) * len(chain.markers_plc_m)
    points = tuple(
        _bearing(chain, survey, sightings, known + i, name) for i, name in enumerate(sightings.names)
    )
    return Unknowns(parameters, len(survey.looks), stations, points)


def _station(chain: Chain, survey: Survey, index: int) -> Transform:
    for look in survey.looks:
        if look.rover is None or look.rover.station != index:
            continue
        points = triangulate(chain.model, look.rover.uv_px)
        found = np.flatnonzero(np.isfinite(points).all(axis=1))
        if len(found) >= 3:
            return chain.site_ih(look.head_rad) @ linear_guess(points[found], chain.markers_plc_m[found])
    raise ValueError(f"station {index}: got no look with 3 markers in both cameras, expected one")


def _bearing(chain: Chain, survey: Survey, sightings: TargetImages, target: int, name: str) -> Bearing:
    mast = np.array([0.0, 0.0, chain.rig.head.mast_height_m])
    if name in survey.landmarks:
        return Bearing.towards(mast, np.asarray(survey.landmarks[name].position_site_m, dtype=np.float64))
    rows = np.flatnonzero((sightings.target == target) & sightings.seen.any(axis=0))
    if len(rows) == 0:  # left out: it only has to be somewhere
        return Bearing.towards(mast, np.array([_DISTANCE_M, 0.0, 0.0]))
    row = max(rows, key=lambda row: int(sightings.seen[:, row].sum()))
    point = _in_head(chain, sightings.uv_px[:, [row]], sightings.seen[:, row])
    return Bearing.towards(mast, chain.site_ih(survey.looks[sightings.look[row]].head_rad).apply(point))


def _in_head(chain: Chain, uv_px: Array, seen: Mask) -> Array:
    """A point (3,) in ih on the line of sight, at the triangulated distance if that makes sense."""
    camera = int(np.flatnonzero(seen)[0])
    ray = chain.model.rays_ih(uv_px)[camera, 0]
    distance = float(triangulate(chain.model, uv_px)[0] @ ray) if seen.all() else _DISTANCE_M
    if not NEAREST_M < distance < FARTHEST_M:
        distance = _DISTANCE_M
    return np.asarray(chain.model.position_ih_m[camera] + distance * ray)
