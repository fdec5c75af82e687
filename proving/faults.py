"""Faults of the ports: they wrap devices, so that they act on any backend, and on hardware."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from executive.faults import Cue, Fault, FaultSpec
from executive.ports import Action, Cameras, Devices, Tracks
from executive.types import Centres, Images, Outcome, Shot, TrackReading
from executive.units import Fraction


class Nothing(BaseModel):
    """No parameters."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class Scale(BaseModel):
    """Which track's encoder, and how much it counts for what the belt really travels."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    side: Annotated[str, Field(pattern="^(left|right)$")]
    factor: Annotated[Fraction, Field(ge=0.5, le=2)] = 1.1


class FrozenFrame(Fault):
    """The frame buffer is not refreshed: every frame of a shot is its first one again, LEDs or not."""

    def __init__(self, parameters: Nothing) -> None:
        self.frozen = 0

    def wrap(self, devices: Devices, cue: Cue) -> Devices:
        return replace(devices, cameras=_FrozenCameras(devices.cameras, cue, self))

    def took_effect(self) -> bool:
        return self.frozen > 0


@dataclass
class _FrozenCameras:
    inner: Cameras
    cue: Cue
    fault: FrozenFrame

    def take(self, shot: Shot) -> Action[Images | Centres]:
        action = self.inner.take(shot)
        return _Frozen(action, self.fault) if self.cue.active else action


@dataclass
class _Frozen:
    inner: Action[Images | Centres]
    fault: FrozenFrame
    outcome: Outcome[Images | Centres] | None = None

    def poll(self) -> Outcome[Images | Centres] | None:
        answer = self.inner.poll() if self.outcome is None else None
        if answer is not None:
            self.outcome = answer if answer.value is None else replace(answer, value=_frozen(answer.value))
            self.fault.frozen += answer.value is not None
        return self.outcome

    def cancel(self) -> None:
        self.inner.cancel()


def _frozen(answer: Images | Centres) -> Images | Centres:
    """The same shot with nothing but its first frame in it: no difference, hence no marker."""
    if isinstance(answer, Centres):
        return replace(answer, uv_px=np.full_like(answer.uv_px, np.nan))
    left, right = (np.repeat(counts[:1], len(counts), axis=0) for counts in answer.counts)
    return replace(answer, counts=(left, right))


class EncoderScale(Fault):
    """One encoder miscounts. The motor is driven by what it counts, so the belt's true travel is off."""

    def __init__(self, parameters: Scale) -> None:
        self.factors = (
            parameters.factor if parameters.side == "left" else 1.0,
            parameters.factor if parameters.side == "right" else 1.0,
        )
        self.miscounted_m = 0.0

    def wrap(self, devices: Devices, cue: Cue) -> Devices:
        return replace(devices, tracks=_MiscountedTracks(devices.tracks, cue, self))

    def took_effect(self) -> bool:
        return self.miscounted_m > 0.0


class _MiscountedTracks:
    """Counts on from what it said last, so that nothing jumps at onset or end."""

    def __init__(self, inner: Tracks, cue: Cue, fault: EncoderScale) -> None:
        self._inner, self._cue, self._fault = inner, cue, fault
        self._true_m = self._said_m = self._travels(inner.read())

    def drive(self, left_m: float, right_m: float, speed_m_s: float) -> Action[TrackReading]:
        left, right = self._fault.factors if self._cue.active else (1.0, 1.0)
        return _Miscounted(self._inner.drive(left_m / left, right_m / right, speed_m_s), self)

    def stop(self) -> None:
        self._inner.stop()

    def read(self) -> TrackReading:
        return self.miscount(self._inner.read())

    def miscount(self, reading: TrackReading) -> TrackReading:
        """The reading as this encoder would have it."""
        factors = self._fault.factors if self._cue.active else (1.0, 1.0)
        true_m = self._travels(reading)
        steps = [now - before for now, before in zip(true_m, self._true_m, strict=True)]
        self._fault.miscounted_m += sum(abs(s * (f - 1.0)) for s, f in zip(steps, factors, strict=True))
        left, right = (m + s * f for m, s, f in zip(self._said_m, steps, factors, strict=True))
        self._true_m, self._said_m = true_m, (left, right)
        return replace(reading, left_m=left, right_m=right)

    @staticmethod
    def _travels(reading: TrackReading) -> tuple[float, float]:
        return reading.left_m, reading.right_m


@dataclass
class _Miscounted:
    inner: Action[TrackReading]
    tracks: _MiscountedTracks
    outcome: Outcome[TrackReading] | None = None

    def poll(self) -> Outcome[TrackReading] | None:
        answer = self.inner.poll() if self.outcome is None else None
        if answer is not None:
            value = None if answer.value is None else self.tracks.miscount(answer.value)
            self.outcome = replace(answer, value=value)
        return self.outcome

    def cancel(self) -> None:
        self.inner.cancel()


FROZEN_FRAME = FaultSpec(
    "frozen_frame",
    "The cameras deliver the first frame of a shot over and over, so that no LED shows in any difference.",
    Nothing,
    FrozenFrame,
    "marker_lost",
    category="cameras",
)
ENCODER_SCALE = FaultSpec(
    "encoder_scale",
    "One track's encoder miscounts, and its belt travels less or more than commanded without a sign of it.",
    Scale,
    EncoderScale,
    "track_asymmetry",
    category="tracks",
)
