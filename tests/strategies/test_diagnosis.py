"""The rover's hypotheses: each signature leads to its own, and each keeps what a plug-in must."""

from __future__ import annotations

import math

import pytest

from executive.core.types import Reason
from executive.isc import Evidence, HypothesisBank, Measured, known_channels, known_hypotheses
from executive.testing import check_channel, check_hypothesis

BANK = HypothesisBank(known_hypotheses(), known_channels())


def after(channels: dict[str, object], weights: dict[str, float] | None = None) -> dict[str, float]:
    evidence = Evidence(0.0, {name: Measured(value) for name, value in channels.items()})
    return BANK.weigh(weights or BANK.prior, evidence)


@pytest.mark.parametrize("hypothesis", known_hypotheses(), ids=lambda h: h.name)
def test_each_hypothesis_keeps_its_promises(hypothesis) -> None:
    check_hypothesis(hypothesis)


@pytest.mark.parametrize("channel", known_channels(), ids=lambda c: c.name)
def test_each_channel_keeps_its_promises(channel) -> None:
    check_channel(channel)


@pytest.mark.parametrize(
    ("channels", "expected"),
    [
        ({"turn_ratio": 0.4}, "slip_turning"),
        ({"advance_ratio": 0.55, "current_ratio": 1.2}, "slip_longitudinal"),
        ({"advance_ratio": 0.02, "current_ratio": 2.6}, "stuck_on_obstacle"),
        ({"heading_z": 5.0, "advance_ratio": 1.0}, "track_asymmetry"),
        ({"markers_missing": 0.25}, "marker_lost"),
        ({"markers_missing": 1.0}, "marker_lost"),
        ({"failure": Reason.OVERSHOOT}, "overshoot"),
        ({"failure": Reason.BLOCKED}, "stuck_on_obstacle"),
        ({"failure": Reason.UNSTABLE_IMAGES}, "illumination_change"),
        ({"advance_ratio": 1.02, "markers_missing": 0.0, "heading_z": 0.3}, "nominal"),
    ],
)
def test_each_signature_leads_to_its_hypothesis(channels: dict[str, object], expected: str) -> None:
    weights = after(channels, after(channels))
    assert max(weights, key=weights.__getitem__) == expected


def test_the_priors_are_those_of_fourteen_equals() -> None:
    assert math.isclose(BANK.prior["nominal"], 0.8)
    assert {round(w, 12) for name, w in BANK.prior.items() if name != "nominal"} == {round(0.2 / 14, 12)}
