"""Faults of the LEDs on the payload cabin, and of what is seen in their place."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Self

from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from executive.core.units import Angle, Fraction, Length
from sim_pybullet.faults.base import Parameters, WorldFault, spec
from sim_pybullet.seeing import Glint, Screen

if TYPE_CHECKING:
    from sim_pybullet.world_faults import WorldActivity, WorldFaults

MarkerIndex = Annotated[int, Field(ge=0, le=3)]
BETWEEN_GLINTS_RAD = 2.4  # the golden angle: any number of them lies well apart
GLINT_HEIGHT_M = 0.14  # above the cabin, so that it shows from all round


class Markers(Parameters):
    """Which of the four LEDs, counted from 0: one `marker`, or several `markers`."""

    marker: Annotated[MarkerIndex | None, Field(description="one LED, counted from 0")] = None
    markers: (
        Annotated[tuple[MarkerIndex, ...], Field(min_length=1, max_length=4, description="several LEDs")]
        | None
    ) = None

    @model_validator(mode="after")
    def one_way_to_say_it(self) -> Self:
        if (self.marker is None) == (self.markers is None):
            got = "neither" if self.marker is None else "both"
            text = f"got {got} of marker and markers, expected exactly one of them"
            raise PydanticCustomError("located", "{text}", {"text": text})
        return self

    @property
    def chosen(self) -> tuple[int, ...]:
        """The LEDs that are meant."""
        return self.markers if self.markers is not None else (self.marker or 0,)


class Dimming(Markers):
    """Which LEDs, and to how much of their nominal power they fall."""

    factor: Annotated[Fraction, Field(ge=0, le=1, description="power, of the nominal one")] = 0.3


class Pair(Parameters):
    """The two LEDs, counted from 0, whose lines are exchanged."""

    markers: Annotated[tuple[MarkerIndex, MarkerIndex], Field(description="the two LEDs")] = (0, 2)

    @model_validator(mode="after")
    def two_of_them(self) -> Self:
        if self.markers[0] == self.markers[1]:
            text = f"got marker {self.markers[0]} twice, expected two different ones"
            raise PydanticCustomError("located", "{text}", {"text": text})
        return self


class Reflections(Parameters):
    """How many spots, the first in phase with LED `marker`, the others with those after it in turn.

    They lie round the rover at this distance from its middle, the first at this bearing from its heading;
    each is `strength` times as bright as its LED.
    """

    marker: Annotated[
        MarkerIndex,
        Field(description="the LED that the first spot blinks with; the next ones take the LEDs after it"),
    ] = 0
    count: Annotated[int, Field(ge=1, le=5, description="how many spots")] = 1
    away: Annotated[Length, Field(ge=0.02, le=2, description="their distance from the rover's middle")] = 0.1
    bearing: Annotated[Angle, Field(description="of the first one, from the rover's heading")] = math.radians(
        60
    )
    strength: Annotated[Fraction, Field(ge=1, le=10, description="brightness, of that of the LED")] = 1.5


class Hiding(Markers):
    """Which LEDs, how large a thing hangs before each, and how far before it on the way to the head."""

    size: Annotated[Length, Field(gt=0, le=0.2, description="diameter of what hangs there")] = 0.03
    away: Annotated[
        Length, Field(gt=0, le=1, description="its distance from the marker, towards the head")
    ] = 0.08


class LedOff(WorldFault[Markers]):
    """Markers go out."""

    def act(self, sim: WorldFaults, level: float) -> None:
        for marker in self.p.chosen:
            sim.set_led(marker, alive=level == 0.0)

    def shows(self, sim: WorldFaults, done: WorldActivity) -> bool:
        return any(done.lit[m] for m in self.p.chosen)


class LedDim(WorldFault[Dimming]):
    """Markers lose power."""

    def act(self, sim: WorldFaults, level: float) -> None:
        for marker in self.p.chosen:
            sim.dim_led(marker, 1.0 - (1.0 - self.p.factor) * level)

    def shows(self, sim: WorldFaults, done: WorldActivity) -> bool:
        return any(done.lit[m] for m in self.p.chosen)


class LedStuckOn(WorldFault[Markers]):
    """Markers burn in every frame, so that no difference between frames shows them."""

    def act(self, sim: WorldFaults, level: float) -> None:
        mask = sum(1 << m for m in set(self.p.chosen))
        others = sim.world.seeing.always_lit & ~mask
        sim.see(always_lit=others | mask if level else others)

    def shows(self, sim: WorldFaults, done: WorldActivity) -> bool:
        return any(done.frames > done.lit[m] for m in self.p.chosen)


class LedSwapped(WorldFault[Pair]):
    """Two markers' lines are exchanged: each shows up where the other is expected."""

    def act(self, sim: WorldFaults, level: float) -> None:
        lines = [0, 1, 2, 3]
        a, b = self.p.markers
        if level:
            lines[a], lines[b] = b, a
        sim.see(wiring=tuple(lines))

    def shows(self, sim: WorldFaults, done: WorldActivity) -> bool:
        return any(done.lit[m] for m in self.p.markers)


class FalseReflection(WorldFault[Reflections]):
    """Something shiny on the rover throws back an LED's light, and blinks with it, brighter than the LED."""

    def act(self, sim: WorldFaults, level: float) -> None:
        sim.see(glints=tuple(self._glint(k) for k in range(self.p.count)) if level else ())

    def _glint(self, number: int) -> Glint:
        angle = self.p.bearing + number * BETWEEN_GLINTS_RAD
        place = (self.p.away * math.cos(angle), self.p.away * math.sin(angle), GLINT_HEIGHT_M)
        return Glint((self.p.marker + number) % 4, place, self.p.strength)

    def shows(self, sim: WorldFaults, done: WorldActivity) -> bool:
        return any(done.lit[glint.led] for glint in sim.world.seeing.glints)


class MarkerOccluded(WorldFault[Hiding]):
    """Something loose on the cabin hangs between markers and head; another attitude may show them again."""

    def act(self, sim: WorldFaults, level: float) -> None:
        sim.see(screens=tuple(self._screen(sim, m) for m in self.p.chosen) if level else ())

    def _screen(self, sim: WorldFaults, marker: int) -> Screen:
        """A ball on the line from the marker to the head as they stand now, fixed to the cabin."""
        place = sim.world.rig.markers.positions_plc_m[marker]
        x, y, z = (p + self.p.away * d for p, d in zip(place, sim.towards_head(marker), strict=True))
        return Screen((x, y, z), self.p.size / 2)

    def shows(self, sim: WorldFaults, done: WorldActivity) -> bool:
        return any(done.lit[m] for m in self.p.chosen) and any(
            sim.hides(ball, self.p.chosen) for ball in sim.screens()
        )


LOST, OUTLIER = "marker_lost", "localisation_outlier"
LED_OFF = spec("led_off", LedOff, Markers, LOST, "markers")
LED_DIM = spec("led_dim", LedDim, Dimming, LOST, "markers", graded=True)
LED_STUCK_ON = spec("led_stuck_on", LedStuckOn, Markers, LOST, "markers")
LED_SWAPPED = spec("led_swapped", LedSwapped, Pair, OUTLIER, "markers")
FALSE_REFLECTION = spec("false_reflection", FalseReflection, Reflections, OUTLIER, "markers")
MARKER_OCCLUDED = spec("marker_occluded", MarkerOccluded, Hiding, LOST, "markers")
