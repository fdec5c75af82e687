"""What stands between a scene and a clean image of it: light, lenses, reflections, things in the way.

Everything is absent by default. Frozen and hashable, so that two moments that look alike can be told to.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from executive.core.types import Vec3

if TYPE_CHECKING:
    from sim_pybullet.sunlight import Sun


@dataclass(frozen=True)
class Lens:
    """One camera's optics: blur beyond its own point spread [px], stray light over sunlit ground's."""

    blur_px: float = 0.0
    veil: float = 0.0


CLEAN = Lens()


@dataclass(frozen=True)
class Glint:
    """A second spot of an LED's light, off something shiny that is fixed to the rover's body."""

    led: int
    position_body_m: Vec3
    strength: float
    """Its brightness over that of the LED itself."""


@dataclass(frozen=True)
class Screen:
    """Something opaque and round that moves with the payload cabin."""

    centre_plc_m: Vec3
    radius_m: float


@dataclass(frozen=True)
class Seeing:
    """All of it. `clouds` is the share of daylight that they let through.

    The sun stands at `sun` (None: where it did at the start) and gives `daylight` times the light on level
    ground for which the exposure was set.

    Line i of the sequencer drives LED `wiring[i]`; the LEDs of the mask `always_lit` burn in every frame.
    The lander's base, and with it the head, has moved by `lander_shift_m` and turned about the mast's foot
    by the rotation vector `lander_turn_rad`, both in `site`.
    """

    lenses: tuple[Lens, Lens] = (CLEAN, CLEAN)
    clouds: float = 1.0
    sun: Sun | None = None
    daylight: float = 1.0
    wiring: tuple[int, int, int, int] = (0, 1, 2, 3)
    always_lit: int = 0
    glints: tuple[Glint, ...] = ()
    screens: tuple[Screen, ...] = ()
    lander_shift_m: Vec3 = (0.0, 0.0, 0.0)
    lander_turn_rad: Vec3 = (0.0, 0.0, 0.0)

    @property
    def light(self) -> float:
        """Light on level ground over that for which the exposure was set."""
        return self.clouds * self.daylight

    def lit(self, lines: int) -> int:
        """The LEDs that burn (bit i = LED i) while the sequencer drives these lines."""
        driven = sum(1 << led for line, led in enumerate(self.wiring) if lines >> line & 1)
        return driven | self.always_lit


CLEAR = Seeing()
