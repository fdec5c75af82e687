"""What may be wrong with a tethered, tracked rover with markers on it, and how each would show."""

from __future__ import annotations

from executive.core.types import Reason
from executive.isc import Categorical, Concern, Gaussian, Hypothesis


def _failing(*reasons: Reason) -> Categorical[Reason]:
    return Categorical(frozenset(reasons), 0.7, 0.01)


def _markers_complete(likelihood: float) -> Categorical[float]:
    return Categorical(frozenset({0.0}), likelihood, round(1 - likelihood, 6))


SLIP_LONGITUDINAL = Hypothesis(
    "slip_longitudinal",
    "The soil gives way: less advance than predicted.",
    {"advance_ratio": Gaussian(0.55, 0.25)},
)
SLIP_TURNING = Hypothesis(
    "slip_turning", "The soil turns the rover less than predicted.", {"turn_ratio": Gaussian(0.7, 0.5)}
)
TRACK_ASYMMETRY = Hypothesis(
    "track_asymmetry", "One track drives less than the other.", {"heading_z": Gaussian(0.0, 6.0)}
)
SIDE_DRIFT = Hypothesis(
    "side_drift",
    "A slope pulls the rover aside.",
    {"cross_z": Gaussian(0.0, 6.0), "tilt": Gaussian(0.25, 0.12)},
)
STUCK_ON_OBSTACLE = Hypothesis(
    "stuck_on_obstacle",
    "Something holds the rover while its belts turn.",
    {
        "advance_ratio": Gaussian(0.05, 0.12),
        "turn_ratio": Gaussian(0.05, 0.12),
        "heading_z": Gaussian(0.0, 5.0),
        "current_ratio": Gaussian(1.6, 0.8),  # belts that slide draw little more than rolling ones
        "failure": _failing(Reason.BLOCKED),
    },
)
TILT_RISK = Hypothesis(
    "tilt_risk",
    "The ground is steeper than the rover should stand on.",
    {"tilt": Gaussian(0.55, 0.12), "failure": _failing(Reason.TILT)},
)
TETHER_SNAG = Hypothesis(
    "tether_snag",
    "The tether holds the rover back.",
    {
        "tether": Gaussian(8.0, 4.0),
        "advance_ratio": Gaussian(0.4, 0.4),
        "failure": _failing(Reason.TETHER),
    },
)
MARKER_LOST = Hypothesis(
    "marker_lost",
    "A marker is dark or hidden.",
    {"markers_missing": _markers_complete(0.05), "failure": _failing(Reason.NOT_SEEN)},
    concerns=Concern.SIGHT,
)
POOR_VIEW = Hypothesis(
    "poor_view",
    "The markers face away from the head, or show small.",
    {"markers_missing": _markers_complete(0.4), "failure": _failing(Reason.POOR_VIEW)},
    concerns=Concern.SIGHT,
)
ILLUMINATION_CHANGE = Hypothesis(
    "illumination_change",
    "The light changes while images are taken.",
    {"failure": _failing(Reason.UNSTABLE_IMAGES)},
    concerns=Concern.SIGHT,
)
LOST_ROVER = Hypothesis(
    "lost_rover",
    "The rover is not where the head looks.",
    {"failure": _failing(Reason.NOT_SEEN, Reason.POOR_VIEW)},
    concerns=Concern.SIGHT,
)
LOCALISATION_OUTLIER = Hypothesis(
    "localisation_outlier",
    "A fix is false.",
    {
        "failure": _failing(Reason.IMPLAUSIBLE),
        "cross_z": Gaussian(0.0, 15.0),
        "heading_z": Gaussian(0.0, 15.0),
    },
    concerns=Concern.FIX,
)
OVERSHOOT = Hypothesis(
    "overshoot",
    "The rover ran past its target.",
    {"failure": _failing(Reason.OVERSHOOT), "advance_ratio": Gaussian(1.35, 0.2)},
)
HEAD_MISALIGNED = Hypothesis(
    "head_misaligned",
    "The head does not look where its encoders say.",
    {"failure": _failing(Reason.MISALIGNED)},
    concerns=Concern.REFERENCE,
)
