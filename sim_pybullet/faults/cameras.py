"""Faults of what the cameras see through and stand on."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field

from executive.core.types import LEFT, RIGHT
from executive.core.units import Angle
from sim_pybullet.faults.base import Parameters, WorldFault, spec

if TYPE_CHECKING:
    from sim_pybullet.seeing import Lens
    from sim_pybullet.world_faults import WorldActivity, WorldFaults


class CameraChoice(Parameters):
    """Which camera."""

    camera: Annotated[Literal["left", "right", "both"], Field(description="which one")] = "both"

    def has(self, camera: int) -> bool:
        """Whether LEFT or RIGHT is meant."""
        return self.camera in ("both", {LEFT: "left", RIGHT: "right"}[camera])


class Blur(CameraChoice):
    """Which camera, and the width of the blur in pixels: the standard deviation of a Gaussian."""

    sigma: Annotated[
        float,
        Field(gt=0, le=20, description="width of the blur in pixels, the standard deviation of a Gaussian"),
    ] = 2.0


class Trembling(Parameters):
    """How far the head sways to either side of where it points."""

    amplitude: Annotated[Angle, Field(gt=0, le=math.radians(2), description="to either side")] = math.radians(
        0.03
    )


class ImageBlur(WorldFault[Blur]):
    """Dust or a shifted lens blurs the images: markers spread out and drown sooner."""

    def act(self, sim: WorldFaults, level: float) -> None:
        left, right = (
            self._blurred(camera, lens, level) for camera, lens in enumerate(sim.world.seeing.lenses)
        )
        sim.see(lenses=(left, right))

    def _blurred(self, camera: int, lens: Lens, level: float) -> Lens:
        return replace(lens, blur_px=self.p.sigma * level) if self.p.has(camera) else lens

    def shows(self, sim: WorldFaults, done: WorldActivity) -> bool:
        return done.frames > 0


class HeadVibration(WorldFault[Trembling]):
    """The mast trembles, so that the frames of one shot do not show the same view."""

    def act(self, sim: WorldFaults, level: float) -> None:
        sim.world.head.sway_rad = self.p.amplitude * level

    def shows(self, sim: WorldFaults, done: WorldActivity) -> bool:
        return done.frames > 1


IMAGE_BLUR = spec("image_blur", ImageBlur, Blur, "poor_view", "cameras", graded=True)
HEAD_VIBRATION = spec(
    "head_vibration", HeadVibration, Trembling, "illumination_change", "cameras", graded=True
)
