"""The `world:` mapping of a scenario, as the simulation understands it. Frozen; SI inside, units in files."""

from __future__ import annotations

import math
import os
from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationInfo, field_validator, model_validator

from executive.core.units import (
    Acceleration,
    Angle,
    Fraction,
    Length,
    Pressure,
)
from sim_pybullet.soil import SOILS, Soil

SoilName = Literal["crust", "loose_sand", "gravel", "bedrock"]


class _Model(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class PointConfig(_Model):
    """A point in the horizontal plane."""

    x: Length
    y: Length


class WindowConfig(_Model):
    """A square of the elevation model: its lower left corner and width, in metres of the model, y up."""

    x: Length
    y: Length
    width: Annotated[Length, Field(gt=0)]


class ProceduralConfig(_Model):
    """Ground made from numbers."""

    roughness: Annotated[Length, Field(ge=0, le=0.05)] = 0.008
    craters: Annotated[int, Field(ge=0, le=200)] = 0
    slope: Annotated[Angle, Field(ge=0, le=math.radians(40))] = 0.0
    slope_direction: Angle = 0.0
    rocks: Annotated[int, Field(ge=0, le=500)] = 30
    width: Annotated[Length, Field(gt=1, le=40)] = 24.0


class TerrainConfig(_Model):
    """Either an elevation model (`dem`, with `window`, `scale`, …) or `procedural` ground."""

    dem: Path | None = None
    window: WindowConfig | None = None
    scale: Annotated[float, Field(gt=0)] = 1.0
    cell: Annotated[Length, Field(gt=0)] | None = None
    lander: PointConfig | None = None
    added_roughness: Annotated[Length, Field(ge=0, le=0.05)] = 0.0
    rocks: Annotated[int, Field(ge=0, le=500)] = 0
    procedural: ProceduralConfig | None = None

    @field_validator("dem")
    @classmethod
    def _seen_from_its_file(cls, dem: Path | None, info: ValidationInfo) -> Path | None:
        """A relative path starts from the file that says it; absolute from here on."""
        folder = (info.context or {}).get("folder", Path())
        return None if dem is None else (folder / dem).absolute()

    @model_validator(mode="before")
    @classmethod
    def _procedural_by_default(cls, given: object) -> object:
        if isinstance(given, dict) and given.get("dem") is None and given.get("procedural") is None:
            return given | {"procedural": {}}
        return given

    @field_validator("dem")
    @classmethod
    def _from_its_file(cls, dem: Path | None, info: ValidationInfo) -> Path | None:
        """Relative to the file that names it."""
        folder = (info.context or {}).get("folder")
        return dem if dem is None or folder is None else Path(os.path.normpath(folder / dem))

    @model_validator(mode="after")
    def _one_kind(self) -> TerrainConfig:
        if self.dem is not None and self.procedural is not None:
            raise ValueError("got both `dem` and `procedural`, expected one of them")
        if self.dem is None and self.window is not None:
            raise ValueError("got a `window` without a `dem` to cut it from")
        return self


class SoilConfig(_Model):
    """A soil of one's own, starting from a named one."""

    like: SoilName = "crust"
    friction: Annotated[Fraction, Field(gt=0, le=1.5)] | None = None
    cohesion: Annotated[Pressure, Field(ge=0)] | None = None
    shear_length: Annotated[Length, Field(gt=0, le=0.1)] | None = None
    yaw_efficiency: Annotated[Fraction, Field(gt=0, le=1)] | None = None
    yaw_scatter: Annotated[Fraction, Field(ge=0, le=0.5)] | None = None
    slip_scatter: Annotated[Fraction, Field(ge=0, le=0.5)] | None = None
    side_slip: Annotated[Fraction, Field(ge=0, le=1)] | None = None

    def soil(self) -> Soil:
        """The soil that this describes."""
        base = SOILS[self.like]

        def either(own: float | None, default: float) -> float:
            return default if own is None else own

        return Soil(
            friction=either(self.friction, base.friction),
            cohesion_pa=either(self.cohesion, base.cohesion_pa),
            shear_m=either(self.shear_length, base.shear_m),
            yaw_efficiency=either(self.yaw_efficiency, base.yaw_efficiency),
            yaw_scatter=either(self.yaw_scatter, base.yaw_scatter),
            slip_scatter=either(self.slip_scatter, base.slip_scatter),
            side_slip=either(self.side_slip, base.side_slip),
        )


AnySoil = SoilName | SoilConfig


def soil_of(given: AnySoil) -> Soil:
    """The soil that a file names or describes."""
    return given.soil() if isinstance(given, SoilConfig) else SOILS[given]


class PatchConfig(_Model):
    """A disc of other soil."""

    at: PointConfig
    radius: Annotated[Length, Field(gt=0)]
    soil: AnySoil


class SoilsConfig(_Model):
    """What the ground is made of; later patches cover earlier ones."""

    default: AnySoil = "loose_sand"
    patches: tuple[PatchConfig, ...] = ()


class LightConfig(_Model):
    """The sun: elevation above the horizon, azimuth of where it stands, from site x, left positive."""

    sun_elevation: Annotated[Angle, Field(ge=0, le=math.pi / 2)] = math.radians(35.0)
    sun_azimuth: Angle = math.radians(110.0)


class StartConfig(_Model):
    """How the rover stands at the first way-point. Heading default: away from the lander, within +-10 deg."""

    heading: Angle | None = None
    position_error: Annotated[Length, Field(ge=0, le=0.1)] = 0.003


class ObstacleConfig(_Model):
    """A rock put exactly here: a sphere of this radius, its centre `height` above the ground."""

    at: PointConfig
    radius: Annotated[Length, Field(gt=0, le=1)]
    height: Length = 0.0


class WorldConfig(_Model):
    """The world of a scenario."""

    terrain: TerrainConfig = TerrainConfig.model_validate({})
    soil: SoilsConfig = SoilsConfig()
    light: LightConfig = LightConfig()
    mast_height: Annotated[Length, Field(gt=0, le=5)] | None = None
    gravity: Annotated[Acceleration, Field(gt=0, le=30)] = 3.71
    time_scale: Annotated[float, Field(ge=5, le=60)] = 30.0
    start: StartConfig = StartConfig()
    obstacles: tuple[ObstacleConfig, ...] = ()

    @field_validator("time_scale")
    @classmethod
    def _finite(cls, value: float) -> float:
        if not math.isfinite(value):
            raise ValueError("got a scale that is not finite")
        return value
