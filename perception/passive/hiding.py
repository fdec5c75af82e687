"""Which of the rover's solids hides which: they are convex and stand apart, so planes tell."""

from __future__ import annotations

from executive.types import Array
from perception.passive.solids import Solids

_TOUCHING_M = 1e-6


def near_first(solids: Solids, eye_body_m: Array) -> tuple[int, ...]:
    """Solids in an order in which none is hidden by a later one, seen from a point (3,) in `body`.

    Solids that pass through each other may hide one another in a ring; one of them is then taken first.
    """
    waiting = list(range(int(solids.solid.max()) + 1))
    order: list[int] = []
    while waiting:
        free = [s for s in waiting if not any(_hides(solids, o, s, eye_body_m) for o in waiting if o != s)]
        order.append((free or waiting)[0])
        waiting.remove(order[-1])
    return tuple(order)


def _hides(solids: Solids, front: int, back: int, eye: Array) -> bool:
    """Whether some facet's plane has `front` on the eye's side and `back` on the other."""
    for solid, other, sign in ((back, front, 1.0), (front, back, -1.0)):
        mine = solids.solid == solid
        point, normal = solids.point_m[mine], solids.normal[mine]
        toward = sign * ((eye - point) * normal).sum(axis=-1) > 0
        depth = (solids.solid_vertices(other)[None] - point[:, None]) @ normal[..., None]
        if (toward & (depth[..., 0] > -_TOUCHING_M).all(axis=1)).any():
            return True
    return False
