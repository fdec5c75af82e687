"""What may go wrong in the yard. Each acts on the simulated world and shows evidence that it did."""

from __future__ import annotations

from typing import Annotated, Any, Generic, Literal, TypeVar

from executive.core.units import Fraction, Power
from longarm import Backend, Fault, FaultSpec, LongarmError
from pydantic import BaseModel, ConfigDict, Field

from yard_robot.backend import YardBackend
from yard_robot.marker_box import FACES
from yard_robot.world import World

_SLIPPED_M = 0.05
_DRAINED = 0.01


class _Parameters(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Slip(_Parameters):
    """Which wheels, and how much of their travel is lost."""

    side: Annotated[Literal["left", "right", "both"], Field(description="which wheels")] = "both"
    slip: Annotated[Fraction, Field(gt=0, lt=1, description="share of their travel that is lost")] = 0.4


class Drain(_Parameters):
    """How fast the battery empties."""

    power: Annotated[Power, Field(gt=0, le=20_000, description="what the leak draws")] = 2000.0


class Cover(_Parameters):
    """Which faces of the box of markers are covered: those that the camera sees, or all."""

    faces: Annotated[Literal["seen", "all"], Field(description="which faces")] = "seen"


class Shade(_Parameters):
    """How much light still reaches the camera's sensor."""

    left: Annotated[Fraction, Field(ge=0, lt=1, description="share of the light that is left")] = 0.03


P = TypeVar("P", bound=_Parameters)


class YardFault(Fault, Generic[P]):
    """Acts on the world by level, 0 puts it right again. Subclasses write `act` and `shows`."""

    def __init__(self, parameters: P) -> None:
        self.p = parameters
        self._level = 0.0
        self._since = 0.0
        self._shown = False

    def apply(self, backend: Backend, level: float) -> None:
        world = _world(backend)
        if self._level == 0.0:
            self._since = self.measure(world)
        self._level = level
        self.act(world, level)

    def watch(self, backend: Backend) -> None:
        world = _world(backend)
        self._shown = self._shown or self.shows(self.measure(world) - self._since)

    def took_effect(self) -> bool:
        return self._shown

    def act(self, world: World, level: float) -> None:
        """Bring the world into the state of this level."""
        raise TypeError(f"{type(self).__name__} does nothing")

    def measure(self, world: World) -> float:
        """What the evidence is counted by; by default pictures taken."""
        return float(world.eye.taken)

    def shows(self, since_onset: float) -> bool:
        """Whether so much since the onset shows that something went otherwise."""
        return since_onset > 0


class WheelSlip(YardFault[Slip]):
    """Wheels spin on what they stand on: they turn as commanded, and the robot does not follow."""

    def act(self, world: World, level: float) -> None:
        slip = self.p.slip * level
        world.slip = (
            slip if self.p.side in ("left", "both") else 0.0,
            slip if self.p.side in ("right", "both") else 0.0,
        )

    def measure(self, world: World) -> float:
        return world.lost_m

    def shows(self, since_onset: float) -> bool:
        return since_onset > _SLIPPED_M


class BatteryDrain(YardFault[Drain]):
    """A short circuit drains the battery."""

    def act(self, world: World, level: float) -> None:
        world.battery.leak_w = self.p.power * level

    def measure(self, world: World) -> float:
        return world.battery.leaked

    def shows(self, since_onset: float) -> bool:
        return since_onset > _DRAINED


class MarkerCovered(YardFault[Cover]):
    """Something blows over the box of markers and hides the faces that the camera sees."""

    def act(self, world: World, level: float) -> None:
        if level == 0.0:
            world.model.covered = frozenset()
        elif not world.model.covered:
            world.model.covered = frozenset(FACES if self.p.faces == "all" else world.faces_seen())


class CameraDark(YardFault[Shade]):
    """The camera's iris sticks nearly shut."""

    def act(self, world: World, level: float) -> None:
        world.iris = 1.0 - (1.0 - self.p.left) * level


def _world(backend: Backend) -> World:
    if not isinstance(backend, YardBackend):
        raise LongarmError(f"got a backend of type {type(backend).__name__}, expected the yard")
    return backend.world


def _spec(
    name: str, fault: type[YardFault[Any]], model: type[_Parameters], hypothesis: str, category: str
) -> FaultSpec:
    doc = " ".join((fault.__doc__ or "").split())
    return FaultSpec(
        name,
        doc,
        model,
        fault,
        hypothesis,
        backends=("yard",),
        tiers=("full",),
        category=category,
        graded=True,
    )


SLIPPING = _spec("wheel_slip", WheelSlip, Slip, "wheel_slip", "terrain")
BATTERY_DRAIN = _spec("battery_drain", BatteryDrain, Drain, "battery_low", "other")
COVERED = _spec("marker_covered", MarkerCovered, Cover, "marker_covered", "markers")
CAMERA_DARK = _spec("camera_dark", CameraDark, Shade, "illumination_change", "light")
