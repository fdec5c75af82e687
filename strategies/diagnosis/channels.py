"""Evidence channels. Ratios are measured over predicted; z values are normalised innovations."""

from __future__ import annotations

from executive.core.types import Reason, TetherReading
from executive.isc import Categorical, Channel, Comparison, Gaussian, Measured


def _markers_missing(seen: Comparison) -> Measured[float] | None:
    if seen.fix is None or not seen.markers_expected:
        return None
    missing = max(seen.markers_expected - seen.fix.markers, 0)
    return Measured(missing / seen.markers_expected)


def _tilt(seen: Comparison) -> Measured[float] | None:
    return None if seen.fix is None else Measured(seen.fix.tilt_rad)


def _cross_z(seen: Comparison) -> Measured[float] | None:
    innovation = seen.innovation
    return None if innovation is None else Measured(innovation.cross_m / innovation.sigma_cross_m)


def _heading_z(seen: Comparison) -> Measured[float] | None:
    innovation = seen.innovation
    if innovation is None or seen.turn_ratio is not None:  # the ratio says it better
        return None
    return Measured(innovation.heading_rad / innovation.sigma_heading_rad)


def _current_ratio(seen: Comparison) -> Measured[float] | None:
    drawn_a, usual_a = seen.since.mean_current_a, seen.usual_current_a
    return Measured(drawn_a / usual_a) if seen.fix is not None and drawn_a is not None and usual_a else None


def _failure(seen: Comparison) -> Measured[Reason] | None:
    return None if seen.failure is None else Measured(seen.failure)


def _tether(seen: Comparison) -> Measured[float] | None:
    reading = seen.readings.get("tether", TetherReading)
    return None if reading is None else Measured(reading.tension_n)


MARKERS_MISSING = Channel(
    "markers_missing",
    "Share of the markers expected that the fix does not rest on.",
    "",
    Categorical(frozenset({0.0}), 0.95, 0.05),
    _markers_missing,
)
TILT = Channel("tilt", "Angle between the body's z axis and the vertical.", "rad", Gaussian(0.1, 0.12), _tilt)
CROSS_Z = Channel(
    "cross_z", "Innovation across the predicted heading over its spread.", "", Gaussian(0.0, 1.2), _cross_z
)
TURN_RATIO = Channel(
    "turn_ratio",
    "Measured turn over predicted, after a turn of 3 deg and more.",
    "",
    Gaussian(1.0, 0.08),
    lambda seen: seen.turn_ratio,
)
HEADING_Z = Channel(
    "heading_z",
    "Innovation of the heading over its spread, where nothing was turned.",
    "",
    Gaussian(0.0, 1.2),
    _heading_z,
)
ADVANCE_RATIO = Channel(
    "advance_ratio",
    "Measured advance over predicted, after 20 mm and more.",
    "",
    Gaussian(1.0, 0.08),
    lambda seen: seen.advance_ratio,
)
CURRENT_RATIO = Channel(
    "current_ratio",
    "Mean motor current over that of drives that went as predicted.",
    "",
    Gaussian(1.0, 0.4),
    _current_ratio,
)
FAILURE = Channel(
    "failure", "Why something failed.", "", Categorical(frozenset({Reason.DONE}), 0.7, 0.01), _failure
)
TETHER = Channel("tether", "Pull of the tether at the spool.", "N", Gaussian(0.5, 1.0), _tether)
