"""Faults of the cameras, in both tiers: in the images, or in what can be measured in them.

What is altered is decided when a shot is asked for; the time stamps stay honest.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from executive.core.devices import CAMERAS
from executive.core.ports import Action, Cameras, Devices
from executive.core.types import (
    LEFT,
    RIGHT,
    Centres,
    Images,
    Landmarks,
    Outcome,
    Reason,
    Shot,
)
from executive.core.units import Duration
from executive.run import Cue, FaultSpec
from proving.faults.altered import Altered, Counted, Held
from proving.faults.parameters import SIDES, Nothing, OneCamera, Parameters

Frames = Images | Centres
Counts = NDArray[np.uint16]


class CameraFault(Counted):
    """What becomes of a shot's answer. Subclasses write `images` and `centres`, or `take`."""

    def wrap(self, devices: Devices, cue: Cue) -> Devices:
        return devices.replace(CAMERAS, _FaultyCameras(devices[CAMERAS], cue, self))

    def take(self, cameras: Cameras, shot: Shot, cue: Cue) -> Action[Frames]:
        """Take the shot while the fault is there."""
        level = cue.level()
        return Altered(cameras.take(shot), lambda outcome: self.alter(outcome, level))

    def alter(self, outcome: Outcome[Frames], level: float) -> Outcome[Frames]:
        """The outcome with its answer altered; counted if that changed anything."""
        if outcome.value is None:
            return outcome
        before = outcome.value
        after = self.centres(before, level) if isinstance(before, Centres) else self.images(before, level)
        self.altered += differ(before, after)
        return replace(outcome, value=after)

    def images(self, answer: Images, level: float) -> Images:
        return answer

    def centres(self, answer: Centres, level: float) -> Centres:
        return answer


def differ(before: Frames, after: Frames) -> bool:
    """Whether two answers to the same shot say something different."""
    if isinstance(before, Centres) and isinstance(after, Centres):
        same = np.array_equal(before.uv_px, after.uv_px, equal_nan=True)
        same = same and np.array_equal(before.sigma_px, after.sigma_px, equal_nan=True)
        return not (same and _same_ground(before, after))
    if isinstance(before, Images) and isinstance(after, Images):
        return not all(np.array_equal(b, a) for b, a in zip(before.counts, after.counts, strict=True))
    return True


def _same_ground(before: Centres, after: Centres) -> bool:
    pairs = zip(before.ground or (), after.ground or (), strict=False)
    return all(np.array_equal(b.names, a.names) and np.array_equal(b.uv_px, a.uv_px) for b, a in pairs)


def with_ground(answer: Centres, camera: int, change: Callable[[Landmarks], Landmarks]) -> Centres:
    """The same centres with what one camera shows of the ground changed, if anything."""
    if answer.ground is None:
        return answer
    left, right = answer.ground
    ground = (change(left), right) if camera == LEFT else (left, change(right))
    return replace(answer, ground=ground)


def no_ground(landmarks: Landmarks) -> Landmarks:
    """None of these."""
    return Landmarks(landmarks.names[:0], landmarks.uv_px[:0])


def with_counts(answer: Images, camera: int, counts: Counts) -> Images:
    """The same images with one camera's stack replaced."""
    left, right = answer.counts
    return replace(answer, counts=(counts, right) if camera == LEFT else (left, counts))


@dataclass
class _FaultyCameras:
    inner: Cameras
    cue: Cue
    fault: CameraFault

    def take(self, shot: Shot) -> Action[Frames]:
        return self.fault.take(self.inner, shot, self.cue) if self.cue.active else self.inner.take(shot)


class CameraDead(CameraFault):
    """One camera delivers frames without a single count."""

    def __init__(self, parameters: OneCamera) -> None:
        self._camera = SIDES.index(parameters.camera)

    def images(self, answer: Images, level: float) -> Images:
        return with_counts(answer, self._camera, np.zeros_like(answer.counts[self._camera]))

    def centres(self, answer: Centres, level: float) -> Centres:
        uv_px = answer.uv_px.copy()
        uv_px[self._camera] = np.nan
        return with_ground(replace(answer, uv_px=uv_px), self._camera, no_ground)


class FrozenFrame(CameraFault):
    """The frame buffer is not refreshed: every frame of a shot is its first one again, LEDs or not."""

    def __init__(self, parameters: Nothing) -> None: ...

    def images(self, answer: Images, level: float) -> Images:
        left, right = (np.repeat(counts[:1], len(counts), axis=0) for counts in answer.counts)
        return replace(answer, counts=(left, right))

    def centres(self, answer: Centres, level: float) -> Centres:
        return replace(answer, uv_px=np.full_like(answer.uv_px, np.nan))


class Lateness(Parameters):
    """How late."""

    by: Annotated[Duration, Field(gt=0, le=86400, description="how long the frames are held back")] = 60.0


class LateFrame(CameraFault):
    """The frames arrive late, stamped with the time at which they were taken."""

    def __init__(self, parameters: Lateness) -> None:
        self._by_s = parameters.by

    def take(self, cameras: Cameras, shot: Shot, cue: Cue) -> Action[Frames]:
        return Held(cameras.take(shot), cue.clock, self._by_s, self)


class MissingFrame(CameraFault):
    """The shot is taken, and its frames are lost on the way."""

    def __init__(self, parameters: Nothing) -> None: ...

    def alter(self, outcome: Outcome[Frames], level: float) -> Outcome[Frames]:
        if not outcome.ok:
            return outcome
        self.altered += 1
        return Outcome(Reason.DEVICE, "the frames did not arrive")


class SwappedCameras(CameraFault):
    """Both cables are swapped: each camera reads out the other's window, and counts as the other."""

    def __init__(self, parameters: Nothing) -> None: ...

    def take(self, cameras: Cameras, shot: Shot, cue: Cue) -> Action[Frames]:
        windows = None if shot.windows is None else (shot.windows[RIGHT], shot.windows[LEFT])
        taken = cameras.take(replace(shot, windows=windows))
        return Altered(taken, lambda outcome: self._swapped(outcome, shot))

    def _swapped(self, outcome: Outcome[Frames], shot: Shot) -> Outcome[Frames]:
        """The answer to the shot as it was asked for, the cameras swapped in it."""
        answer = outcome.value
        if answer is None:
            return outcome
        after: Frames
        if isinstance(answer, Centres):
            ground = None if answer.ground is None else (answer.ground[RIGHT], answer.ground[LEFT])
            uv_px, sigma_px = answer.uv_px[::-1], answer.sigma_px[::-1]
            after = replace(answer, shot=shot, uv_px=uv_px, sigma_px=sigma_px, ground=ground)
        else:
            windows, counts = answer.windows[::-1], answer.counts[::-1]
            after = replace(answer, shot=shot, windows=windows, counts=counts)
        self.altered += differ(answer, after)
        return replace(outcome, value=after)


CAMERA_DEAD = FaultSpec(
    "camera_dead",
    "One camera delivers frames without a single count.",
    OneCamera,
    CameraDead,
    "marker_lost",
    category="cameras",
)
FROZEN_FRAME = FaultSpec(
    "frozen_frame",
    "The cameras deliver the first frame of a shot over and over, so that no LED shows in any difference.",
    Nothing,
    FrozenFrame,
    "marker_lost",
    category="cameras",
)
LATE_FRAME = FaultSpec(
    "late_frame",
    "The frames of a shot arrive late, stamped with the time at which they were taken.",
    Lateness,
    LateFrame,
    "",
    category="cameras",
)
MISSING_FRAME = FaultSpec(
    "missing_frame",
    "The frames of a shot are lost on the way; the cameras report a device failure.",
    Nothing,
    MissingFrame,
    "",
    category="cameras",
)
SWAPPED_CAMERAS = FaultSpec(
    "swapped_cameras",
    "The cables of both cameras are swapped: left is right.",
    Nothing,
    SwappedCameras,
    "localisation_outlier",
    category="cameras",
)
