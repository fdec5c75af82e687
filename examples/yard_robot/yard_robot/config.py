"""What a scenario may say of the yard: `world:` in its file."""

from __future__ import annotations

import math
from typing import Annotated

from executive.core.units import Angle, Fraction, Length, Power
from pydantic import BaseModel, ConfigDict, Field


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class GroundConfig(_Part):
    """Packed earth with soft patches. Efficiencies are true turning per that of the treads."""

    turning: Annotated[Fraction, Field(gt=0.2, le=1)] = 0.62
    turning_in_patches: Annotated[Fraction, Field(gt=0.2, le=1)] = 0.52
    slip_in_patches: Annotated[Fraction, Field(ge=0, lt=0.5)] = 0.04
    scatter: Annotated[Fraction, Field(ge=0, le=0.2, description="of slip, from place to place")] = 0.02
    patches: Annotated[int, Field(ge=0, le=50)] = 6
    patch_radius: Annotated[Length, Field(gt=0, le=5)] = 0.8


class BatteryConfig(_Part):
    """The battery and what it feeds. `capacity` is in watt hours."""

    capacity: Annotated[float, Field(gt=0, le=1000, description="[W h]")] = 40.0
    charge: Annotated[Fraction, Field(gt=0, le=1)] = 0.8
    idle: Annotated[Power, Field(ge=0, le=1000)] = 20.0
    solar: Annotated[Power, Field(ge=0, le=2000, description="what the panel yields by a clear day")] = 250.0


class StartConfig(_Part):
    """How far the robot may stand from where ground believes it: standard deviations."""

    place: Annotated[Length, Field(ge=0, le=0.3)] = 0.03
    heading: Annotated[Angle, Field(ge=0, le=math.radians(30))] = math.radians(5)


class YardConfig(_Part):
    """The yard and the robot in it. `light` is 1 by a clear day."""

    ground: GroundConfig = GroundConfig()
    battery: BatteryConfig = BatteryConfig()
    start: StartConfig = StartConfig()
    light: Annotated[float, Field(gt=0, le=1.5)] = 1.0
    gravity: Annotated[float, Field(gt=0, le=30, description="[m/s^2]")] = 9.81
