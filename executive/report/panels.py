"""Small multiples of the telemetry."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from executive.core import registry
from executive.core.device_spec import DEVICE_KIND
from executive.core.types import Array
from executive.record.events import DeviceReading, Telemetry
from executive.record.history import At
from executive.report import palette, svg
from executive.report.axes import Chart, Scale, legend, time_axis, timed
from executive.report.figure import Figure
from executive.report.gather import RecordedRun

_WIDTH, _LEFT, _TOP, _BOTTOM = 540.0, 44.0, 30.0, 140.0
_LEAST_TRAVEL_M = 0.02


class Series(NamedTuple):
    """One line of a panel; `dots` draws its points as well."""

    name: str
    colour: str
    time_s: Array
    values: Array
    dots: bool = False


Panel = tuple[str, Sequence[Series]]
"""A title with the unit, and the lines."""


def telemetry(run: RecordedRun) -> Figure | None:
    """A panel for each channel over the same mission time; None where no telemetry was recorded."""
    panels = [*_of_rover(run), *of_devices(run)]
    if not panels:
        return None
    cards = "".join(_panel(run, title, series) for title, series in panels if series)
    caption = (
        "What the devices reported, one sample a tick. The slip estimate compares, "
        "from one localisation to the next, the distance covered with what the belts travelled; it is 0 "
        "where the tracks grip and 1 where they spin in place. Stretches with less than 20 mm of travel "
        "are left out."
    )
    return Figure("telemetry", "Telemetry", f"<div class='panels'>{cards}</div>", caption)


def of_devices(run: RecordedRun) -> Iterator[Panel]:
    """A panel for each quantity that a device reported on its own, in the unit of its type."""
    known = registry.every(DEVICE_KIND)
    by_device: dict[str, list[At[DeviceReading]]] = {}
    for at in run.history.all(DeviceReading):
        by_device.setdefault(at.event.device, []).append(at)
    for device, samples in sorted(by_device.items()):
        quantities = known[device].quantities if device in known else ()
        units = {quantity.name: quantity.type.unit for quantity in quantities}
        t = np.array([at.time_s for at in samples])
        for name in sorted({name for at in samples for name in at.event.values}):
            unit = units.get(name)
            factor, shown = (180 / math.pi, "deg") if unit == "rad" else (1.0, unit or "-")
            values = np.array([at.event.values.get(name, math.nan) for at in samples]) * factor
            yield f"{device}: {name} [{shown}]".replace("_", " "), [Series(name, palette.ESTIMATE, t, values)]


def _of_rover(run: RecordedRun) -> list[Panel]:
    """Six panels of what a rover with head and tether reports together; none for any other robot."""
    samples = run.history.all(Telemetry)
    if not samples:
        return []
    t = np.array([at.time_s for at in samples])

    def channel(name: str, factor: float = 1.0) -> Array:
        return np.array([getattr(at.event, name) for at in samples]) * factor

    degrees, left, right = 180 / math.pi, palette.ESTIMATE, palette.FIX
    return [
        (
            "motor current [A]",
            [
                Series("left", left, t, channel("left_current_a")),
                Series("right", right, t, channel("right_current_a")),
            ],
        ),
        (
            "tilt of the body [deg]",
            [
                Series("roll", left, t, channel("roll_rad", degrees)),
                Series("pitch", right, t, channel("pitch_rad", degrees)),
            ],
        ),
        (
            "belt travel [m]",
            [Series("left", left, t, channel("left_m")), Series("right", right, t, channel("right_m"))],
        ),
        ("slip between localisations [-]", _slip(run, t, (channel("left_m") + channel("right_m")) / 2)),
        (
            "head [deg]",
            [
                Series("pan", left, t, channel("pan_rad", degrees)),
                Series("tilt", right, t, channel("tilt_rad", degrees)),
            ],
        ),
        ("tether tension [N]", [Series("tension", left, t, channel("tether_n"))]),
    ]


def _panel(run: RecordedRun, title: str, series: Sequence[Series]) -> str:
    finite = np.concatenate([s.values[np.isfinite(s.values)] for s in series])
    low, high = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 1.0)
    if 0 < low < 0.9 * high:
        low = 0.0  # a force or a current is read against nothing
    margin = 0.08 * (high - low) or 0.5 * abs(high) or 0.5
    time = Scale(0.0, run.end_s, _LEFT, _WIDTH - 6)
    chart = Chart(time, Scale(low - margin, high + margin, _BOTTOM, _TOP))
    lines = [chart.line(s.time_s, s.values, stroke=s.colour, stroke_width=1.2) for s in series]
    dots = [
        svg.element("circle", cx=chart.time(t), cy=chart.value.clamp(v), r=2.4, fill=s.colour)
        for s in series
        if s.dots
        for t, v in zip(s.time_s, s.values, strict=True)
    ]
    body = [time_axis(time, _TOP, _BOTTOM), chart.frame(title), *lines, *dots]
    drawn = svg.drawing(_WIDTH, _BOTTOM + 22, body, aria_label=title, **timed(time, _TOP, _BOTTOM))
    names = legend(("line", s.colour, s.name) for s in series) if len(series) > 1 else ""
    return f"<div class='panel'>{names}{drawn}</div>"


def _slip(run: RecordedRun, time_s: Array, travel_m: Array) -> list[Series]:
    """1 - distance / belt travel between successive fixes, at the time of the later one."""
    rows = []
    for before, after in pairwise(run.fixes):
        belts = float(np.interp(after.time_s, time_s, travel_m) - np.interp(before.time_s, time_s, travel_m))
        if abs(belts) >= _LEAST_TRAVEL_M:
            moved = math.hypot(after.x_m - before.x_m, after.y_m - before.y_m)
            rows.append((after.time_s, 1 - moved / abs(belts)))
    if not rows:
        return []
    times, slip = np.array(rows).T
    return [Series("slip", palette.ESTIMATE, times, slip, dots=True)]
