"""Faults of the track encoders. A motor is driven by what its encoder counts, so the belt's travel is off."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
from pydantic import Field

from executive.core.devices import DRIVE
from executive.core.ports import Action, Devices, Drive
from executive.core.types import (
    Array,
    Outcome,
    Reason,
    TrackReading,
)
from executive.core.units import Current, Fraction
from executive.run import Cue, FaultSpec
from proving.faults.altered import Counted
from proving.faults.parameters import SIDES, OneTrack

COUNT_M = 0.0005  # one count of the encoder; for less the motor does not start again


class EncoderFault(Counted):
    """One encoder counts otherwise than its belt travels. Subclasses say how: `counts` and `rate`."""

    def __init__(self, parameters: OneTrack) -> None:
        self.side = SIDES.index(parameters.side)

    def wrap(self, devices: Devices, cue: Cue) -> Devices:
        return devices.replace(DRIVE, _MiscountedTracks(devices[DRIVE], cue, self))

    def rate(self, level: float) -> float:
        """What is counted of a metre of belt on average; the motor stops when it has counted enough."""
        return 1.0

    def counts(self, step_m: float, cue: Cue) -> float:
        """What is counted of a belt's travel [m]."""
        return step_m * self.rate(cue.level())


class Scale(OneTrack):
    """Which track's encoder, and how much it counts for what the belt really travels."""

    factor: Annotated[
        Fraction, Field(ge=0.5, le=2, description="travel counted, of the belt's true travel")
    ] = 1.1


class EncoderScale(EncoderFault):
    """One encoder counts too much or too little of every metre."""

    def __init__(self, parameters: Scale) -> None:
        super().__init__(parameters)
        self._factor = parameters.factor

    def rate(self, level: float) -> float:
        return 1.0 + level * (self._factor - 1.0)


class EncoderStuck(EncoderFault):
    """One encoder counts nothing: its belt runs on until someone stops it."""

    def rate(self, level: float) -> float:
        return 0.0 if level > 0.0 else 1.0


class Loss(OneTrack):
    """Which track's encoder, and the share of its counts that is lost."""

    share: Annotated[Fraction, Field(gt=0, le=0.9, description="counts lost, on average")] = 0.2


class EncoderLostCounts(EncoderFault):
    """One encoder loses counts at random: its belt travels further than commanded."""

    def __init__(self, parameters: Loss) -> None:
        super().__init__(parameters)
        self._share = parameters.share

    def rate(self, level: float) -> float:
        return 1.0 - level * self._share

    def counts(self, step_m: float, cue: Cue) -> float:
        made = max(1, round(abs(step_m) / COUNT_M))
        return step_m * (1.0 - cue.rng.binomial(made, cue.level() * self._share) / made)


class _MiscountedTracks:
    """Counts on from what it said last, so that nothing jumps at onset or end."""

    def __init__(self, inner: Drive, cue: Cue, fault: EncoderFault) -> None:
        self.inner, self._cue, self._fault = inner, cue, fault
        self._true_m = travels(inner.read())
        self.said_m = self._true_m.copy()

    def drive(self, left_m: float, right_m: float, speed_m_s: float) -> Action[TrackReading]:
        self.read()
        return _Servo(self, self.said_m + np.array([left_m, right_m]), speed_m_s)

    def start(self, missing_m: Array, speed_m_s: float) -> Action[TrackReading]:
        """Drive the belts by what will be counted as `missing_m`; one that counts nothing is not slowed."""
        belts_m = missing_m.copy()
        belts_m[self._fault.side] /= self._fault.rate(self._cue.level()) or 1.0
        return self.inner.drive(float(belts_m[0]), float(belts_m[1]), speed_m_s)

    def stop(self) -> None:
        self.inner.stop()

    def read(self) -> TrackReading:
        return self.miscount(self.inner.read())

    def miscount(self, reading: TrackReading) -> TrackReading:
        """The reading as this encoder would have it."""
        steps_m = travels(reading) - self._true_m
        side, step_m = self._fault.side, float(steps_m[self._fault.side])
        if step_m != 0.0 and self._cue.active:
            steps_m[side] = self._fault.counts(step_m, self._cue)
            self._fault.altered += bool(steps_m[side] != step_m)
        self._true_m, self.said_m = travels(reading), self.said_m + steps_m
        return replace(reading, left_m=float(self.said_m[0]), right_m=float(self.said_m[1]))


def travels(reading: TrackReading) -> Array:
    """Belt travel, left and right [m]."""
    return np.array([reading.left_m, reading.right_m])


@dataclass
class _Servo:
    """A drive that ends when everything asked for has been counted, however far the belts must run."""

    tracks: _MiscountedTracks
    goal_m: Array
    speed_m_s: float
    outcome: Outcome[TrackReading] | None = None

    def __post_init__(self) -> None:
        self._asked_m = self.goal_m - self.tracks.said_m
        self._inner = self.tracks.start(self._asked_m, self.speed_m_s)

    def poll(self) -> Outcome[TrackReading] | None:
        answer = self._inner.poll() if self.outcome is None else None
        if answer is None:
            return self.outcome
        said = None if answer.value is None else self.tracks.miscount(answer.value)
        missing_m = self._missing_m()
        if answer.reason is Reason.DONE and missing_m.any():
            self._inner = self.tracks.start(missing_m, self.speed_m_s)
            return None
        self.outcome = replace(answer, value=said)
        return self.outcome

    def cancel(self) -> None:
        self._inner.cancel()

    def _missing_m(self) -> Array:
        """What has not been counted yet; a belt that has gone too far is not turned back."""
        missing_m = self.goal_m - self.tracks.said_m
        ahead: Array = np.where(missing_m * self._asked_m > COUNT_M * np.abs(self._asked_m), missing_m, 0.0)
        return ahead


class Garbage(OneTrack):
    """Which motor's current, and how large the garbage is."""

    up_to: Annotated[Current, Field(gt=0, le=100, description="largest current reported")] = 2.0


class CurrentsGarbage(Counted):
    """One motor's current sensor reports anything at all, now and then not even a number."""

    def __init__(self, parameters: Garbage) -> None:
        self._left, self._up_to_a = parameters.side == "left", parameters.up_to

    def wrap(self, devices: Devices, cue: Cue) -> Devices:
        def garbled(reading: TrackReading) -> TrackReading:
            if not cue.active:
                return reading
            self.altered += 1
            garbage = cue.rng.uniform(-1.0, 1.0) * self._up_to_a if cue.rng.uniform() < 0.9 else math.nan
            if self._left:
                return replace(reading, left_current_a=garbage)
            return replace(reading, right_current_a=garbage)

        return devices.replace(DRIVE, _AlteredTracks(devices[DRIVE], garbled))


@dataclass
class _AlteredTracks:
    """Tracks whose readings are altered, and nothing else."""

    inner: Drive
    alter: Callable[[TrackReading], TrackReading]

    def drive(self, left_m: float, right_m: float, speed_m_s: float) -> Action[TrackReading]:
        return self.inner.drive(left_m, right_m, speed_m_s)

    def stop(self) -> None:
        self.inner.stop()

    def read(self) -> TrackReading:
        return self.alter(self.inner.read())


ENCODER_SCALE = FaultSpec(
    "encoder_scale",
    "One track's encoder miscounts, and its belt travels less or more than commanded without a sign of it.",
    Scale,
    EncoderScale,
    "track_asymmetry",
    category="tracks",
    graded=True,
)
ENCODER_STUCK = FaultSpec(
    "encoder_stuck",
    "One track's encoder counts nothing: once driven, its belt runs on until someone stops it.",
    OneTrack,
    EncoderStuck,
    "track_asymmetry",
    category="tracks",
)
ENCODER_LOST_COUNTS = FaultSpec(
    "encoder_lost_counts",
    "One track's encoder loses counts at random, and its belt travels further than commanded.",
    Loss,
    EncoderLostCounts,
    "track_asymmetry",
    category="tracks",
    graded=True,
)
CURRENTS_GARBAGE = FaultSpec(
    "currents_garbage",
    "One motor's current sensor reports garbage, now and then not even a number.",
    Garbage,
    CurrentsGarbage,
    "",
    category="tracks",
)
