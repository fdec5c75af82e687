"""Ground truth of the simulation, for its own record only: no port leads here."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from executive.types import Quat, Vec3


@dataclass(frozen=True)
class TruthSample:
    """The world at `time_s`: pose of `body` in `site`, true angles [rad], slips (fractions), tether, driving."""

    time_s: float
    position_site_m: Vec3
    quat_site_body: Quat
    pan_rad: float
    tilt_rad: float
    arm_rad: float
    cabin_rad: float
    slip_left: float
    slip_right: float
    tether_m: float
    tether_n: float
    driving: bool


TruthSink = Callable[[TruthSample], None]
