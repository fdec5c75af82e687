"""A rover on plain ground under one fault of the world, and what can be measured of both."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from executive.config.backends import BackendRequest
from executive.core import registry
from executive.core.devices import CAMERAS, DRIVE, HEAD
from executive.core.rig import RigCalibration
from executive.core.types import (
    Array,
    Outcome,
    Shot,
    Window,
)
from executive.run.fault import FAULT_KIND
from perception.frames.difference import led_sequence
from perception.markers.single import find_candidates
from sim_pybullet import BACKEND
from sim_pybullet.backend import SimBackend
from sim_pybullet.config import WorldConfig
from sim_pybullet.projection import head_views
from tests.sim_pybullet.worlds import AHEAD, heading, plain

SPEED_M_S = 0.0014
HALF_WINDOW_PX = 80
PAIRS = 16  # at 3 m they make an SNR of about 10
CLEAR_SNR = 6.0  # noise does not get there


class Bench:
    """One backend in one tier with one fault; while `level` is above 0 the fault is watched every tick."""

    def __init__(self, fault: str, tier: str, parameters: dict[str, Any], **world: Any) -> None:
        config = WorldConfig.model_validate(plain(**world))
        backend = BACKEND.create(BackendRequest(config, AHEAD, 3, tier, RigCalibration(), None, 1.0))
        assert isinstance(backend, SimBackend)
        self.backend, self.world, self.devices = backend, backend.world, backend.devices
        self.spec = registry.get(FAULT_KIND, fault)
        self.fault = self.spec.make(self.spec.model.model_validate(parameters))
        self.level = 0.0
        pan_rad = math.atan2(float(self.position[1]), float(self.position[0]))
        self.gaze = pan_rad, math.atan2(1.4, float(self.position[0]))
        self.point()

    def set_level(self, level: float) -> None:
        """What the schedule does when the level changes."""
        self.level = level
        self.fault.apply(self.backend, level)
        if level:
            self.fault.watch(self.backend)

    def advance(self, ticks: int = 1) -> None:
        for _ in range(ticks):
            self.backend.advance()
            if self.level:
                self.fault.watch(self.backend)

    def finish(self, action: Any, limit: int = 400) -> Outcome[Any] | None:
        """The outcome, or None if there is none within `limit` ticks; then the action is cancelled."""
        for _ in range(limit):
            if (outcome := action.poll()) is not None:
                return outcome
            self.advance()
        action.cancel()
        return None

    @property
    def position(self) -> Array:
        return self.world.body.pose()[0].copy()

    @property
    def heading(self) -> float:
        return heading(self.world.body.pose()[1])

    def drive(self, left_m: float, right_m: float, limit: int = 400) -> Outcome[Any] | None:
        return self.finish(self.devices[DRIVE].drive(left_m, right_m, SPEED_M_S), limit)

    def point(self, pan_rad: float = 0.0, tilt_rad: float = 0.0) -> Outcome[Any] | None:
        """Point the head this far beside where the rover was at first."""
        pan, tilt = self.gaze
        return self.finish(self.devices[HEAD].point(pan + pan_rad, tilt + tilt_rad))

    def shot(self, pairs: int = PAIRS) -> Any:
        """The markers one by one, in windows round where an encoder would have the rover."""
        head = self.devices[HEAD].read()
        middle = self.world.scene().T_site_plc[:3, 3]
        windows = []
        for view in head_views(self.backend.rig, head.pan_rad, head.tilt_rad):
            u, v = (round(float(x)) - HALF_WINDOW_PX for x in view.project(middle)[0])
            windows.append(Window(u, v, 2 * HALF_WINDOW_PX, 2 * HALF_WINDOW_PX))
        outcome = self.finish(self.devices[CAMERAS].take(Shot(led_sequence(4, pairs), tuple(windows), 0.5)))
        assert outcome is not None
        assert outcome.ok
        return outcome.value

    def centres(self) -> Array:
        """Centres (2, 4, 2) [px] as perception finds them, NaN where it does not, all if it refuses."""
        look = find_candidates(self.backend.rig, self.shot(), float(np.linalg.norm(self.position)))
        uv = np.full((2, 4, 2), np.nan)
        for camera, marker in np.ndindex(2, 4):
            clear = [d for d in look.candidates[camera][marker] if d.snr > CLEAR_SNR]
            if clear and not look.problem:
                uv[camera, marker] = clear[0].uv_px
        return uv

    def found(self) -> int:
        """How many of the four markers both cameras show."""
        return int(np.isfinite(self.centres()).all(axis=(0, 2)).sum())

    def close(self) -> None:
        self.backend.close()
