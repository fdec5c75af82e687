"""Terrain and rocks as static bodies in a physics client."""

from __future__ import annotations

import numpy as np

from sim_pybullet.bullet import pybullet
from sim_pybullet.scene import Rock
from sim_pybullet.terrain import Terrain

LANDER_RADIUS_M, LANDER_HEIGHT_M = 0.35, 0.4
GROUND_FRICTION = 1.0  # Bullet multiplies the two frictions of a contact; the soil's value sits on the tracks


def add_terrain(client: int, terrain: Terrain) -> int:
    """The terrain as a heightfield; returns its body. Bullet centres it on its extents in x, y and z."""
    z = terrain.elevation_m
    rows, cols = z.shape
    shape = pybullet.createCollisionShape(
        pybullet.GEOM_HEIGHTFIELD,
        flags=pybullet.GEOM_CONCAVE_INTERNAL_EDGE,
        meshScale=[terrain.cell_m, terrain.cell_m, 1.0],
        heightfieldTextureScaling=1.0,
        heightfieldData=np.ascontiguousarray(z, dtype=np.float32).ravel().tolist(),
        numHeightfieldRows=cols,  # Bullet calls the count along x "rows"
        numHeightfieldColumns=rows,
        physicsClientId=client,
    )
    low, high = terrain.origin_site_m, terrain.corner_site_m
    centre = [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, float(z.min() + z.max()) / 2]
    return _static(client, shape, centre)


def add_rock(client: int, rock: Rock) -> int:
    """A rock as a static sphere; returns its body."""
    shape = pybullet.createCollisionShape(pybullet.GEOM_SPHERE, radius=rock.radius_m, physicsClientId=client)
    return _static(client, shape, list(rock.centre_site_m))


def add_lander(client: int) -> int:
    """The lander's body at the mast's foot, as a static cylinder; returns its body.

    It lies below every line of sight of the head to where the rover may be.
    """
    shape = pybullet.createCollisionShape(
        pybullet.GEOM_CYLINDER, radius=LANDER_RADIUS_M, height=LANDER_HEIGHT_M, physicsClientId=client
    )
    return _static(client, shape, [0.0, 0.0, LANDER_HEIGHT_M / 2])


def _static(client: int, shape: int, position_site_m: list[float]) -> int:
    body = pybullet.createMultiBody(0.0, shape, basePosition=position_site_m, physicsClientId=client)
    # Alone in its call: together with damping arguments Bullet would put friction on the base, silently.
    pybullet.changeDynamics(body, -1, lateralFriction=GROUND_FRICTION, physicsClientId=client)
    return int(body)
