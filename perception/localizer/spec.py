"""The localizer as it registers; what it computes with is imported only when one is made."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Annotated

from pydantic import Field

from executive.config.localizers import LocalizerRequest, LocalizerSpec
from executive.config.validate import Strict
from executive.core.ports import Localizer
from executive.core.rig import RigCalibration
from executive.core.types import Point

MARKERS = "markers"
PASSIVE = "passive"
FAR_M = 9.0
"""Nearer, a fix is good to 3 mm, which no tolerance asks for; and to know that takes a second."""


class LedStereoSettings(Strict):
    """What the localizer does besides looking for markers."""

    outlines: Annotated[
        bool, Field(description="look ahead at empty ground, and for an outline where no marker shows")
    ] = True
    watch_head: Annotated[bool, Field(description="check the head against the ground now and then")] = True


def _make(request: LocalizerRequest) -> Localizer:
    from perception.localizer.localizer import LedStereoLocalizer

    settings = request.settings
    if not isinstance(settings, LedStereoSettings):
        raise TypeError(f"got a {type(settings).__name__}, expected LedStereoSettings")
    return LedStereoLocalizer(request.devices, request.rig, request.clock, settings)


def _markers(rig: RigCalibration) -> int:
    return len(rig.markers.positions_plc_m)


def _preload() -> None:
    from perception.localizer.machine_code import poses, prepare

    prepare(lambda line: None)
    poses()


def _prepare(tell: Callable[[str], None]) -> None:
    from perception.localizer.machine_code import prepare

    prepare(tell)


def _best_sigma_m(rig: RigCalibration, place: Point) -> float:
    if math.hypot(place.x_m, place.y_m) < FAR_M:
        return 0.0

    from perception.localizer.best_fix import best_sigma_m

    return best_sigma_m(rig, place)


LED_STEREO = LocalizerSpec(
    name="led_stereo",
    doc="Active markers in LED difference images of the stereo pair; the rover's outline where none shows.",
    settings=LedStereoSettings,
    sources=(MARKERS, PASSIVE),
    tiers=("full", "geometric"),
    needs=("cameras", "head", "cabin", "inclinometer"),
    rig=RigCalibration,
    expected_markers=_markers,
    make=_make,
    prepare=_prepare,
    preload=_preload,
    best_sigma_m=_best_sigma_m,
)
