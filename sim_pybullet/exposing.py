"""A shot under way: which scene each of its frames saw, and when it is done."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Protocol

from executive.core.clock import Clock
from executive.core.rig import RigCalibration
from executive.core.types import (
    Centres,
    HeadReading,
    Images,
    Outcome,
    Reason,
    Shot,
    Window,
)
from sim_pybullet.scene import SceneSource, SceneState

_SAME_TIME_S = 1e-9

Answer = Images | Centres


class Developer(Protocol):
    """Makes the answer to a shot from the scenes that its frames saw."""

    def develop(
        self, shot: Shot, scenes: tuple[SceneState, ...], head: HeadReading, time_s: float
    ) -> Answer: ...


@dataclass
class ExposureLog:
    """How many frames were exposed so far, and in how many of them each LED's line was driven."""

    frames: int = 0
    driven: list[int] = field(default_factory=lambda: [0] * 4)

    def note(self, lines: int) -> None:
        """Count one frame."""
        self.frames += 1
        for line in range(len(self.driven)):
            self.driven[line] += lines >> line & 1


class Exposing:
    """The action of one shot. Frame i is exposed `i * cadence_s` after the start."""

    def __init__(
        self,
        shot: Shot,
        clock: Clock,
        scene: SceneSource,
        head: HeadReading,
        developer: Developer,
        log: ExposureLog,
    ) -> None:
        self._shot, self._clock, self._scene = shot, clock, scene
        self._head, self._developer = head, developer
        self._start_s = clock.now_s
        self._scenes: list[SceneState] = []
        self._log = log
        self._outcome: Outcome[Answer] | None = None
        self.see()

    def see(self) -> None:
        """Keep the present scene for every frame whose time has come."""
        if self._outcome is not None:
            return
        now: SceneState | None = None
        while len(self._scenes) < len(self._shot.leds) and self._due(len(self._scenes)):
            now = now or self._scene()
            self._log.note(self._shot.leds[len(self._scenes)])
            self._scenes.append(now)

    def poll(self) -> Outcome[Answer] | None:
        if self._outcome is None and self._due(len(self._shot.leds)):
            self.see()
            value = self._developer.develop(self._shot, tuple(self._scenes), self._head, self._clock.now_s)
            self._outcome = Outcome(Reason.DONE, value=value)
            self._scenes.clear()
        return self._outcome

    def cancel(self) -> None:
        if self._outcome is None:
            self._outcome = Outcome(Reason.CANCELLED)

    def _due(self, frames: int) -> bool:
        return self._clock.now_s + _SAME_TIME_S >= self._start_s + frames * self._shot.cadence_s


class Refused:
    """The action of a shot that cannot be taken."""

    def __init__(self, outcome: Outcome[Answer]) -> None:
        self._outcome = outcome

    def poll(self) -> Outcome[Answer]:
        return self._outcome

    def cancel(self) -> None: ...


class SimCameras:
    """The stereo pair with the LED sequencer. The backend calls `tick` once after each tick of time."""

    def __init__(
        self,
        rig: RigCalibration,
        clock: Clock,
        scene: SceneSource,
        head: Callable[[], HeadReading],
        developer: Developer,
    ) -> None:
        self._rig, self._clock, self._scene, self._head = rig, clock, scene, head
        self._developer = developer
        self._under_way: Exposing | None = None
        self.log = ExposureLog()

    def take(self, shot: Shot) -> Exposing | Refused:
        """Start a shot; one under way ends CANCELLED. OUT_OF_REACH for windows beyond the frame."""
        self.cancel()
        complaint = self._complaint(shot)
        if complaint is not None:
            return Refused(Outcome(Reason.OUT_OF_REACH, complaint))
        self._under_way = Exposing(shot, self._clock, self._scene, self._head(), self._developer, self.log)
        return self._under_way

    def tick(self) -> None:
        """Let the frames that are due see the present scene."""
        if self._under_way is not None:
            self._under_way.see()

    def cancel(self) -> None:
        """Drop the shot under way, if any."""
        if self._under_way is not None:
            self._under_way.cancel()
            self._under_way = None

    def _complaint(self, shot: Shot) -> str | None:
        if not shot.leds:
            return "got a shot of 0 frames, expected 1 or more"
        if shot.cadence_s <= 0:
            return f"got a cadence of {shot.cadence_s} s, expected more than 0"
        if not 0 < shot.exposure <= 1:
            return f"got an exposure of {shot.exposure}, expected in (0, 1]"
        for camera, window in zip(self._rig.cameras, shot.windows or (), strict=False):
            inside = (
                min(window.u, window.v) >= 0
                and min(window.width, window.height) > 0
                and window.u + window.width <= camera.width_px
                and window.v + window.height <= camera.height_px
            )
            if not inside:
                return f"got {window}, expected one within {camera.width_px} x {camera.height_px} px"
        return None


def full_windows(rig: RigCalibration) -> tuple[Window, Window]:
    """Both full frames."""
    left, right = (Window(0, 0, camera.width_px, camera.height_px) for camera in rig.cameras)
    return left, right
