"""Faults that act in the simulated world. PyBullet is imported only when one acts, not to list them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from pydantic import BaseModel, ConfigDict, Field

from executive.errors import LongarmError
from executive.faults import Fault, FaultSpec
from executive.ports import Backend
from executive.units import Fraction, Length

if TYPE_CHECKING:
    from sim_pybullet.world_faults import WorldFaults

BACKENDS, TIERS = ("pybullet",), ("full", "geometric")
SIDES = {"left": 0, "right": 1}


class _Parameters(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Marker(_Parameters):
    """Which of the four LEDs, counted from 0."""

    marker: Annotated[int, Field(ge=0, le=3)]


class Dimming(Marker):
    """To how much of its nominal power the LED falls."""

    factor: Annotated[Fraction, Field(ge=0, le=1)] = 0.3


class Slip(_Parameters):
    """The share of all belt travel that is lost, whatever the ground."""

    slip: Annotated[Fraction, Field(gt=0, le=0.95)] = 0.4


class Weakness(_Parameters):
    """Which track, and how fast its motor turns compared with what is commanded."""

    side: Annotated[str, Field(pattern="^(left|right)$")]
    factor: Annotated[Fraction, Field(gt=0, lt=1)] = 0.6


class RockAhead(_Parameters):
    """How far along the planned path ahead of the rover; the rock is a sphere, its centre in the ground."""

    ahead: Annotated[Length, Field(ge=0.25, le=5)] = 0.5
    aside: Annotated[Length, Field(ge=-0.3, le=0.3)] = 0.0
    radius: Annotated[Length, Field(gt=0, le=0.5)] = 0.10


class _WorldFault(Fault):
    def apply(self, backend: Backend, level: float) -> None:
        self.act(_world_of(backend), level > 0.0)

    def act(self, world: WorldFaults, active: bool) -> None:
        raise TypeError(f"{type(self).__name__} does nothing")


class LedOff(_WorldFault):
    def __init__(self, parameters: Marker) -> None:
        self._marker = parameters.marker

    def act(self, world: WorldFaults, active: bool) -> None:
        world.set_led(self._marker, alive=not active)


class LedDim(_WorldFault):
    def __init__(self, parameters: Dimming) -> None:
        self._parameters = parameters

    def act(self, world: WorldFaults, active: bool) -> None:
        world.dim_led(self._parameters.marker, self._parameters.factor if active else 1.0)


class SlipBurst(_WorldFault):
    def __init__(self, parameters: Slip) -> None:
        self._slip = parameters.slip

    def act(self, world: WorldFaults, active: bool) -> None:
        world.set_slip(self._slip if active else 0.0)


class TrackWeak(_WorldFault):
    def __init__(self, parameters: Weakness) -> None:
        self._side, self._factor = SIDES[parameters.side], parameters.factor

    def act(self, world: WorldFaults, active: bool) -> None:
        world.set_track_factor(self._side, self._factor if active else 1.0)


class RockOnPath(_WorldFault):
    def __init__(self, parameters: RockAhead) -> None:
        self._parameters = parameters

    def act(self, world: WorldFaults, active: bool) -> None:
        if active:
            p = self._parameters
            world.add_obstacle(*world.ahead_on_path(p.ahead, p.aside), p.radius)


def _world_of(backend: Backend) -> WorldFaults:
    from sim_pybullet.backend import SimBackend

    if not isinstance(backend, SimBackend):
        raise LongarmError(f"got a backend of type {type(backend).__name__}, expected the simulation")
    return backend.world_faults


LED_OFF = FaultSpec(
    "led_off", "A marker goes out.", Marker, LedOff, "marker_lost", BACKENDS, TIERS, category="markers"
)
LED_DIM = FaultSpec(
    "led_dim", "A marker loses power.", Dimming, LedDim, "marker_lost", BACKENDS, TIERS, category="markers"
)
SLIP_BURST = FaultSpec(
    "slip_burst",
    "The ground gives way: a share of the belts' travel is lost, driving and turning alike.",
    Slip,
    SlipBurst,
    "slip_longitudinal",
    backends=BACKENDS,
    tiers=TIERS,
    category="terrain",
)
TRACK_WEAK = FaultSpec(
    "track_weak",
    "One motor turns slower than commanded, as its encoder sees: the rover swerves until it catches up.",
    Weakness,
    TrackWeak,
    "track_asymmetry",
    backends=BACKENDS,
    tiers=TIERS,
    category="tracks",
)
ROCK_ON_PATH = FaultSpec(
    "rock_on_path",
    "A rock that ground did not know lies on the path ahead of the rover, and stays there.",
    RockAhead,
    RockOnPath,
    "stuck_on_obstacle",
    backends=BACKENDS,
    tiers=TIERS,
    category="terrain",
    lasting=True,
)
