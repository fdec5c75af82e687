"""Faults of the payload cabin's joints."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from sim_pybullet.faults.base import Nothing, WorldFault, spec

if TYPE_CHECKING:
    from sim_pybullet.world_faults import WorldActivity, WorldFaults

BEHIND_RAD = math.radians(0.5)  # a joint this far behind its motor shows that it is locked


class _JointFault(WorldFault[Nothing]):
    def shows(self, sim: WorldFaults, done: WorldActivity) -> bool:
        return sim.world.cabin.behind_rad > BEHIND_RAD


class ArmLocked(_JointFault):
    """The arm's joint seizes: a move of the cabin that needs it ends BLOCKED where the motor gives up."""

    def act(self, sim: WorldFaults, level: float) -> None:
        sim.world.cabin.seize_arm(level > 0.0)
        sim.world.wake()


class CabinLocked(_JointFault):
    """The cabin's joint seizes: the marker plane keeps its angle against the arm, a move ends BLOCKED."""

    def act(self, sim: WorldFaults, level: float) -> None:
        sim.world.cabin.seize_cabin(level > 0.0)
        sim.world.wake()


ARM_LOCKED = spec("arm_locked", ArmLocked, Nothing, "poor_view", "tracks")
CABIN_LOCKED = spec("cabin_locked", CabinLocked, Nothing, "poor_view", "tracks")
