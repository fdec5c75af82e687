"""Ground truth of the simulation, for its own record only: no port leads here."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from executive.record import TruthRecorder
from executive.record.events import TerrainEvent, TruthEvent

from yard_robot.world import World

_EVERY_S = 60.0  # at rest
_CELL_M = 0.5


class TruthFile:
    """Writes samples of the world to `truth.mcap`, or nowhere without a path."""

    def __init__(self, path: Path | None, world: World) -> None:
        self._recorder = TruthRecorder(path) if path is not None else None
        self._world = world
        self._last_s = -_EVERY_S
        self._kept: tuple[TruthEvent, float] | None = None
        self._ground()
        self.sample()

    def sample(self) -> None:
        """Write the present state: every tick in motion and the last before it, else now and then."""
        if self._recorder is None:
            return
        now_s, event = self._world.clock.now_s, self._event()
        if self._world.resting and now_s - self._last_s < _EVERY_S:
            self._kept = (event, now_s)
            return
        if self._kept is not None:
            self._recorder(*self._kept)  # so that nobody interpolates across the rest
        self._recorder(event, now_s)
        self._kept, self._last_s = None, now_s

    def _event(self) -> TruthEvent:
        world = self._world
        position_m, quat = world.body.placed()
        return TruthEvent(
            position_site_m=position_m,
            quat_site_body=quat,
            slip_left=world.slip[0],
            slip_right=world.slip[1],
        )

    def _ground(self) -> None:
        """The map of a level yard."""
        if self._recorder is not None:
            low, high = self._world.area_m
            cells = np.ceil((np.array(high) - low) / _CELL_M).astype(int) + 1
            elevation = np.zeros((int(cells[1]), int(cells[0])), dtype=np.float32)
            self._recorder.write(TerrainEvent(low, _CELL_M, elevation, ()), 0.0)

    def flush(self) -> None:
        """Hand what was written to the operating system."""
        if self._recorder is not None:
            self._recorder.flush()

    def close(self) -> None:
        """Complete the file; may be called twice."""
        if self._recorder is not None:
            self._recorder.close()
