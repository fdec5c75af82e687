"""What several kinds of faults are told."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

Side = Literal["left", "right"]
SIDES: tuple[Side, Side] = ("left", "right")


class Parameters(BaseModel):
    """Base of every fault's parameters: frozen, no unknown keys."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class Nothing(Parameters):
    """No parameters."""


class OneTrack(Parameters):
    """Which track."""

    side: Annotated[Side, Field(description="which track")]


class OneCamera(Parameters):
    """Which camera."""

    camera: Annotated[Side, Field(description="which camera")]
