"""Ground truth of the simulation, for its own record only: no port leads here."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from executive.core.types import Quat, Vec3
from executive.record import TruthRecorder
from executive.record.events import Rock as MapRock
from executive.record.events import TerrainEvent, TruthEvent
from sim_pybullet.scene import Rock
from sim_pybullet.terrain import Terrain

MAP_STEP_M = 0.05


@dataclass(frozen=True)
class TruthSample:
    """The world at `time_s`: pose of `body` in `site`, true angles, slips (fractions), tether, driving."""

    time_s: float
    position_site_m: Vec3
    quat_site_body: Quat
    pan_rad: float
    tilt_rad: float
    arm_rad: float
    cabin_rad: float
    slip_left: float
    slip_right: float
    tether_m: float
    tether_n: float
    driving: bool


TruthSink = Callable[[TruthSample], None]


class TruthFile:
    """Writes samples to `truth.mcap`, or nowhere without a path.

    Where the disk takes no more it raises OSError, once: the world must go on, for the rover to come to rest.
    """

    def __init__(self, path: Path | None) -> None:
        self._recorder = TruthRecorder(path) if path is not None else None

    def write(self, sample: TruthSample) -> None:
        """Add one sample."""
        if self._recorder is not None:
            with self._given_up_if_full(self._recorder):
                self._recorder(_event(sample), sample.time_s)

    def ground(self, terrain: Terrain, rocks: Sequence[Rock]) -> None:
        """Write the map once: elevation thinned out to what a drawing needs, and the rocks."""
        if self._recorder is None:
            return
        stride = max(1, round(MAP_STEP_M / terrain.cell_m))
        self._recorder.write(
            TerrainEvent(
                terrain.origin_site_m,
                terrain.cell_m * stride,
                terrain.elevation_m[::stride, ::stride].astype(np.float32),
                tuple(MapRock(r.centre_site_m[0], r.centre_site_m[1], r.radius_m) for r in rocks),
            ),
            0.0,
        )

    def flush(self) -> None:
        """Hand what was written to the operating system, so that a kill loses a tick at most."""
        if self._recorder is not None:
            with self._given_up_if_full(self._recorder):
                self._recorder.flush()

    def close(self) -> None:
        """Complete the file; may be called twice."""
        if self._recorder is not None:
            self._recorder.close()

    @contextmanager
    def _given_up_if_full(self, recorder: TruthRecorder) -> Iterator[None]:
        try:
            yield
        except OSError:
            self._recorder = None
            with suppress(OSError):
                recorder.close()
            raise


def _event(sample: TruthSample) -> TruthEvent:
    return TruthEvent(
        position_site_m=sample.position_site_m,
        quat_site_body=sample.quat_site_body,
        pan_rad=sample.pan_rad,
        tilt_rad=sample.tilt_rad,
        arm_rad=sample.arm_rad,
        cabin_rad=sample.cabin_rad,
        slip_left=sample.slip_left,
        slip_right=sample.slip_right,
        tether_m=sample.tether_m,
        tether_n=sample.tether_n,
    )
