"""Which of the rover's solids hides which: they are convex and stand apart, so planes tell."""

from __future__ import annotations

import numpy as np

from executive.core.types import Array
from perception.outline.passive.solids import Solids

_TOUCHING_M = 1e-6


def near_first(solids: Solids, eye_body_m: Array) -> tuple[int, ...]:
    """Solids in an order in which none is hidden by a later one, seen from a point (3,) in `body`.

    Where no facet's plane tells, the one goes first that fewest others can hide, of such the nearest.
    """
    waiting = list(range(int(solids.solid.max()) + 1))
    away = [float(np.linalg.norm(solids.solid_vertices(s).mean(axis=0) - eye_body_m)) for s in waiting]
    order: list[int] = []
    while waiting:
        clear = {s: sum(_clear_of(solids, s, o, eye_body_m) for o in waiting if o != s) for s in waiting}
        order.append(max(waiting, key=lambda s: (clear[s], -away[s])))
        waiting.remove(order[-1])
    return tuple(order)


def _clear_of(solids: Solids, front: int, back: int, eye: Array) -> bool:
    """Whether `back` cannot hide `front`: some facet's plane has `front` on the eye's side, `back` beyond."""
    for solid, other, sign in ((back, front, 1.0), (front, back, -1.0)):
        mine = solids.solid == solid
        point, normal = solids.point_m[mine], solids.normal[mine]
        toward = sign * ((eye - point) * normal).sum(axis=-1) > 0
        depth = (solids.solid_vertices(other)[None] - point[:, None]) @ normal[..., None]
        if (toward & (depth[..., 0] > -_TOUCHING_M).all(axis=1)).any():
            return True
    return False
