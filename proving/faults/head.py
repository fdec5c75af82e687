"""Faults of the imaging head's encoders."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated

from pydantic import Field

from executive.core.devices import CAMERAS, HEAD
from executive.core.ports import (
    Action,
    Cameras,
    Devices,
    Head,
)
from executive.core.types import (
    Centres,
    HeadReading,
    Images,
    Outcome,
    Shot,
    Vec2,
)
from executive.core.units import Angle
from executive.run import Cue, FaultSpec
from proving.faults.altered import Altered, Counted
from proving.faults.parameters import Parameters


class HeadOffset(Parameters):
    """What the encoders say more than is true."""

    pan: Annotated[Angle, Field(ge=-0.5, le=0.5, description="said minus true pan, left positive")] = 0.005
    tilt: Annotated[Angle, Field(ge=-0.5, le=0.5, description="said minus true tilt, down positive")] = 0.0


class HeadEncoderOffset(Counted):
    """The head's encoders are off: it points elsewhere than it says, in its readings and with each image."""

    def __init__(self, parameters: HeadOffset) -> None:
        self._pan_rad, self._tilt_rad = parameters.pan, parameters.tilt

    def wrap(self, devices: Devices, cue: Cue) -> Devices:
        off = devices.replace(HEAD, _OffsetHead(devices[HEAD], self, cue))
        return off.replace(CAMERAS, _OffsetCameras(devices[CAMERAS], self, cue))

    def offset_rad(self, cue: Cue) -> Vec2:
        return self._pan_rad * cue.level(), self._tilt_rad * cue.level()

    def said(self, head: HeadReading, cue: Cue) -> HeadReading:
        """The reading as the encoders have it."""
        pan, tilt = self.offset_rad(cue)
        return replace(head, pan_rad=head.pan_rad + pan, tilt_rad=head.tilt_rad + tilt)


@dataclass
class _OffsetHead:
    inner: Head
    fault: HeadEncoderOffset
    cue: Cue

    def point(self, pan_rad: float, tilt_rad: float) -> Action[HeadReading]:
        """Turns until the encoders say so."""
        pan, tilt = self.fault.offset_rad(self.cue)
        return Altered(self.inner.point(pan_rad - pan, tilt_rad - tilt), self._said)

    def read(self) -> HeadReading:
        return self.fault.said(self.inner.read(), self.cue)

    def _said(self, outcome: Outcome[HeadReading]) -> Outcome[HeadReading]:
        value = outcome.value
        return outcome if value is None else replace(outcome, value=self.fault.said(value, self.cue))


@dataclass
class _OffsetCameras:
    inner: Cameras
    fault: HeadEncoderOffset
    cue: Cue

    def take(self, shot: Shot) -> Action[Images | Centres]:
        return Altered(self.inner.take(shot), self._stamped)

    def _stamped(self, outcome: Outcome[Images | Centres]) -> Outcome[Images | Centres]:
        """The answer with the head's angles as the encoders have them."""
        answer = outcome.value
        if answer is None:
            return outcome
        head = self.fault.said(answer.head, self.cue)
        self.fault.altered += head != answer.head
        return replace(outcome, value=replace(answer, head=head))


HEAD_ENCODER_OFFSET = FaultSpec(
    "head_encoder_offset",
    "The head's encoders are off, so that it points elsewhere than it says.",
    HeadOffset,
    HeadEncoderOffset,
    "head_misaligned",
    category="head",
    graded=True,
)
