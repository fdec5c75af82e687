"""What a coded look piles up, shot by shot, and the pose that it shows so far; in both tiers."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from executive.core.types import (
    Centres,
    Images,
    Vec2,
    Window,
)
from perception.frames.exposure import plate_view
from perception.frames.psf import marker_spread
from perception.frames.shots import blackness, check_frames, saturation
from perception.frames.stacking import Stack
from perception.frames.vibration import shaken
from perception.frames.views import Pictures
from perception.geometry.chain import Chain
from perception.geometry.prediction import Expectation
from perception.markers.joint import joint_fix
from perception.markers.marker_fix import MarkerFix, Rejection, with_note
from perception.markers.mean_centres import MeanCentres, fix_from_centres
from perception.markers.observation import Observation


class ShotStack:
    """Sums of images, or of the geometric tier's centres."""

    def __init__(self, chain: Chain) -> None:
        self._chain = chain
        n = len(chain.markers_plc_m)
        self._stacks = [Stack(n, chain.rig.sensor.noise_counts) for _ in (0, 1)]
        self._saturated = ["", ""]
        self._level = [0.0, 0.0]
        self._windows: tuple[Window, Window] | None = None
        self._centres = MeanCentres.none(n)
        self._frames = 0
        self._dark: Pictures | None = None

    def add(self, data: Images | Centres) -> None:
        """Take in one shot; ValueError unless its frames are as ordered, in the windows of all others."""
        if isinstance(data, Centres):
            self._centres = self._centres.with_shot(data)
            self._frames += len(data.shot.leds)
            return
        check_frames(data, self._chain.rig.sensor)
        if self._windows not in (None, data.windows):
            raise ValueError(f"got windows {data.windows}, expected {self._windows} as before")
        self._windows = data.windows
        self._frames += len(data.shot.leds)
        for camera, counts in enumerate(data.counts):
            self._stacks[camera].add(counts, data.shot.leds)
            self._level[camera] = float(np.median(counts[0]))
            self._saturated[camera] = self._saturated[camera] or saturation(counts, self._chain.rig.sensor)

    @property
    def problem(self) -> str:
        """What makes the frames of both cameras unusable, empty as long as one will do."""
        problems = self._problems
        return _named(problems) if all(problems) else ""

    @property
    def _problems(self) -> list[str]:
        """What makes each camera's frames unusable, empty where nothing does."""
        black = blackness((self._level[0], self._level[1]))
        found = zip(black, self._saturated, self._stacks, strict=True)
        return [dark or full or stack.problem for dark, full, stack in found]

    def observation(
        self, data: Images | Centres, pairs: int, expectation: Expectation, tilt_rad: Vec2, widen: float
    ) -> Observation:
        """What all the shots show together; `data` is the last one, `pairs` how many there are in all."""
        fix = self.fix(expectation, tilt_rad, widen)
        nowhere = np.full((2, len(self._chain.markers_plc_m), 2), np.nan)
        detected_px = nowhere if isinstance(fix, Rejection) else fix.detected_px
        return Observation(data, pairs, self._frames, self.problem, fix, self._dark, detected_px)

    def fix(self, expectation: Expectation, tilt_rad: Vec2, widen: float) -> MarkerFix | Rejection:
        """The one pose in the expectation's region that all of it shows, or one camera, the other being
        blind; the note then says so."""
        if self._windows is None:
            return fix_from_centres(self._chain, self._centres, expectation, tilt_rad)
        problems = self._problems
        if all(problems):
            return Rejection(_named(problems), 0)
        differences = [
            None if why else stack.difference() for why, stack in zip(problems, self._stacks, strict=True)
        ]
        left, right = (stack.reference for stack in self._stacks)
        self._dark = (left, right)
        range_m = plate_view(self._chain, expectation.state).range_m
        spread = marker_spread(self._chain.rig, range_m)
        corners = [(w.u, w.v) for w in self._windows]
        chain = shaken(self._chain, [stack.unknown_px for stack in self._stacks])
        fix = joint_fix(chain, differences, corners, spread, expectation, tilt_rad, widen)
        return with_note(fix, _named(problems))


def _named(problems: Sequence[str]) -> str:
    cameras = zip(("left", "right"), problems, strict=True)
    return "; ".join(f"{name} camera: {problem}" for name, problem in cameras if problem)
