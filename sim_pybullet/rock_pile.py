"""The rocks of a world and their bodies in the physics client."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import overload

from sim_pybullet.bullet import pybullet
from sim_pybullet.ground_body import add_rock
from sim_pybullet.scene import Rock


class RockPile(Sequence[Rock]):
    """Rocks that may come, go and move. Each is known by its value; ValueError for one that is not there."""

    def __init__(self, client: int, rocks: Iterable[Rock]) -> None:
        self._client = client
        self._rocks: list[Rock] = []
        self._bodies: list[int] = []
        for rock in rocks:
            self.add(rock)

    def __len__(self) -> int:
        return len(self._rocks)

    @overload
    def __getitem__(self, index: int) -> Rock: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[Rock]: ...
    def __getitem__(self, index: int | slice) -> Rock | Sequence[Rock]:
        return self._rocks[index]

    def add(self, rock: Rock) -> None:
        """Put one more rock into the world."""
        self._rocks.append(rock)
        self._bodies.append(add_rock(self._client, rock))

    def remove(self, rock: Rock) -> None:
        """Take a rock away."""
        index = self._rocks.index(rock)
        del self._rocks[index]
        pybullet.removeBody(self._bodies.pop(index), physicsClientId=self._client)

    def move(self, rock: Rock, to: Rock) -> None:
        """Let a rock be elsewhere; its size stays."""
        index = self._rocks.index(rock)
        self._rocks[index] = to
        pybullet.resetBasePositionAndOrientation(
            self._bodies[index], to.centre_site_m, (0.0, 0.0, 0.0, 1.0), physicsClientId=self._client
        )

    def touches(self, rock: Rock, body: int) -> bool:
        """Whether a rock and another body of the client are in contact."""
        mine = self._bodies[self._rocks.index(rock)]
        return bool(pybullet.getContactPoints(bodyA=mine, bodyB=body, physicsClientId=self._client))
