"""Faults of what is estimated: poses that are wrong, old or no numbers, inclinometers that are off."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Annotated

from pydantic import Field

from executive.core.devices import INCLINOMETER
from executive.core.ports import (
    Action,
    Devices,
    Inclinometer,
    LocaliseRequest,
    Localizer,
)
from executive.core.types import (
    Localisation,
    Outcome,
    PoseEstimate,
    TiltReading,
    Vec2,
)
from executive.core.units import Angle, Length
from executive.run import Cue, FaultSpec
from proving.faults.altered import Altered, Counted
from proving.faults.parameters import Nothing, Parameters


class PoseFault(Counted):
    """Every pose that the localizer finds is altered. Subclasses write `falsify`."""

    def wrap_localizer(self, localizer: Localizer, cue: Cue) -> Localizer:
        return _FalseLocalizer(localizer, self, cue)

    def see(self, pose: PoseEstimate, cue: Cue) -> PoseEstimate:
        """What becomes of a pose found; counted while the fault is there."""
        if not cue.active:
            return pose
        self.altered += 1
        return self.falsify(pose, cue)

    def falsify(self, pose: PoseEstimate, cue: Cue) -> PoseEstimate:
        raise TypeError(f"{type(self).__name__} falsifies nothing")


@dataclass
class _FalseLocalizer:
    inner: Localizer
    fault: PoseFault
    cue: Cue

    def locate(self, request: LocaliseRequest) -> Action[Localisation]:
        return Altered(self.inner.locate(request), self._falsified)

    def pointing(self, pose: PoseEstimate) -> Vec2:
        return self.inner.pointing(pose)

    def _falsified(self, outcome: Outcome[Localisation]) -> Outcome[Localisation]:
        found = outcome.value
        if found is None or found.pose is None:
            return outcome
        return replace(outcome, value=replace(found, pose=self.fault.see(found.pose, self.cue)))


class Shift(Parameters):
    """How far the pose found lies from the one measured, in `site`."""

    x: Annotated[Length, Field(ge=-100, le=100, description="along site x")] = 0.3
    y: Annotated[Length, Field(ge=-100, le=100, description="along site y")] = 0.0


class PoseOutlier(PoseFault):
    """The pose found is shifted, while its covariance claims that it is good."""

    def __init__(self, parameters: Shift) -> None:
        self._shift = parameters

    def falsify(self, pose: PoseEstimate, cue: Cue) -> PoseEstimate:
        x, y, z = pose.position_site_m
        level = cue.level()
        return replace(pose, position_site_m=(x + level * self._shift.x, y + level * self._shift.y, z))


class PoseNan(PoseFault):
    """The pose found is no number."""

    def __init__(self, parameters: Nothing) -> None: ...

    def falsify(self, pose: PoseEstimate, cue: Cue) -> PoseEstimate:
        return replace(pose, position_site_m=(math.nan, math.nan, math.nan))


class Staleness(Parameters):
    """Whether the old pose comes with its old time, or claims to be new."""

    restamped: Annotated[bool, Field(description="with the new pose's time instead of its own")] = False


class PoseStale(PoseFault):
    """The last pose from before the onset is found again and again."""

    def __init__(self, parameters: Staleness) -> None:
        self._restamped = parameters.restamped
        self._last: PoseEstimate | None = None

    def see(self, pose: PoseEstimate, cue: Cue) -> PoseEstimate:
        if not cue.active or self._last is None:
            self._last = pose
            return pose
        return super().see(pose, cue)

    def falsify(self, pose: PoseEstimate, cue: Cue) -> PoseEstimate:
        old = self._last or pose
        return replace(old, time_s=pose.time_s, source=pose.source) if self._restamped else old


class Bias(Parameters):
    """What the inclinometers say more than is true."""

    roll: Annotated[Angle, Field(ge=-0.8, le=0.8, description="said minus true roll")] = 0.0
    pitch: Annotated[Angle, Field(ge=-0.8, le=0.8, description="said minus true pitch")] = math.radians(3.0)


class InclinometerBias(Counted):
    """The inclinometers are off by a constant, all of it along a ramp."""

    def __init__(self, parameters: Bias) -> None:
        self.bias = parameters

    def wrap(self, devices: Devices, cue: Cue) -> Devices:
        return devices.replace(INCLINOMETER, _BiasedInclinometer(devices[INCLINOMETER], self, cue))


@dataclass
class _BiasedInclinometer:
    inner: Inclinometer
    fault: InclinometerBias
    cue: Cue

    def read(self) -> TiltReading:
        reading, level, bias = self.inner.read(), self.cue.level(), self.fault.bias
        roll, pitch = reading.roll_rad + level * bias.roll, reading.pitch_rad + level * bias.pitch
        said = replace(reading, roll_rad=roll, pitch_rad=pitch)
        self.fault.altered += said != reading
        return said


POSE_OUTLIER = FaultSpec(
    "pose_outlier",
    "The localizer finds the rover where it is not, and is sure of it.",
    Shift,
    PoseOutlier,
    "localisation_outlier",
    category="estimation",
    graded=True,
)
POSE_NAN = FaultSpec(
    "pose_nan",
    "The localizer finds a place that is no number.",
    Nothing,
    PoseNan,
    "localisation_outlier",
    category="estimation",
)
POSE_STALE = FaultSpec(
    "pose_stale",
    "The localizer finds the last pose from before the onset again and again.",
    Staleness,
    PoseStale,
    "localisation_outlier",
    category="estimation",
)
INCLINOMETER_BIAS = FaultSpec(
    "inclinometer_bias",
    "The inclinometers are off by a constant.",
    Bias,
    InclinometerBias,
    "",
    category="estimation",
    graded=True,
)
