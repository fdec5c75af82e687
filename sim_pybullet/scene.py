"""What there is to see at one moment: the true poses that cameras look at. Frozen; frames in the names."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from executive.core.types import Array, Vec3
from sim_pybullet.seeing import CLEAR, Seeing


@dataclass(frozen=True)
class Rock:
    """A rock as a sphere, partly buried; `centre_site_m` is the sphere's centre."""

    centre_site_m: Vec3
    radius_m: float


@dataclass(frozen=True)
class Box:
    """A cuboid in a link's frame: `frame` is `body`, `arm` or `cabin`; `size_m` are full edge lengths."""

    name: str
    frame: str
    centre_m: Vec3
    size_m: Vec3


@dataclass(frozen=True, eq=False)
class SceneState:
    """The true state of everything visible at `time_s`. Transforms are 4x4, read-only.

    T_a_b maps homogeneous points of frame b into frame a. `arm` sits at the arm's pivot with x along the arm,
    `cabin` at the cabin's pivot, axes parallel to those of `plc`. `head_*_rad` are the true angles, not the
    encoders'. LED i emits `led_factor[i]` times its nominal power when it is lit and `led_alive[i]`.
    """

    time_s: float
    T_site_body: Array
    T_site_arm: Array
    T_site_cabin: Array
    T_site_plc: Array
    arm_rad: float
    cabin_rad: float
    head_pan_rad: float
    head_tilt_rad: float
    rocks: tuple[Rock, ...] = ()
    led_alive: tuple[bool, bool, bool, bool] = (True, True, True, True)
    led_factor: tuple[float, float, float, float] = (1.0, 1.0, 1.0, 1.0)
    seeing: Seeing = CLEAR

    def T_site(self, frame: str) -> Array:  # noqa: N802  transforms keep their capital T
        """T_site_<frame> for `body`, `arm`, `cabin` or `plc`; KeyError for another."""
        return {
            "body": self.T_site_body,
            "arm": self.T_site_arm,
            "cabin": self.T_site_cabin,
            "plc": self.T_site_plc,
        }[frame]


def screens(scene: SceneState) -> tuple[Rock, ...]:
    """What hangs in the way of light near the cabin, as balls in `site`."""
    T = scene.T_site_plc
    return tuple(
        Rock((float(x), float(y), float(z)), screen.radius_m)
        for screen in scene.seeing.screens
        for x, y, z in (T[:3, :3] @ screen.centre_plc_m + T[:3, 3],)
    )


SceneSource = Callable[[], SceneState]
