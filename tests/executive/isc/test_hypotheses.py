"""Weights: evidence moves them, silence does not, and they come back."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from executive.core.types import Reason
from executive.isc.hypotheses import (
    FAILURE_CODES,
    PRIOR,
    Channel,
    Evidence,
    Hypothesis,
    weigh,
    without,
)


def after(channels: dict[Channel, float], weights: dict[Hypothesis, float] | None = None):
    return weigh(weights or dict(PRIOR), Evidence(0.0, {c: (v, 0.0) for c, v in channels.items()}))


@given(st.dictionaries(st.sampled_from(list(Channel)), st.floats(-50, 50), max_size=6))
def test_weights_always_sum_to_one(channels: dict[Channel, float]) -> None:
    assert sum(after(channels).values()) == pytest.approx(1.0)


def test_no_evidence_leaves_the_prior() -> None:
    assert after({}) == pytest.approx(dict(PRIOR))


def test_a_channel_without_a_number_says_nothing() -> None:
    assert after({Channel.CURRENT_RATIO: math.nan, Channel.MARKERS: 3.0}) == after({Channel.MARKERS: 3.0})


@pytest.mark.parametrize(
    ("channels", "expected"),
    [
        ({Channel.TURN_RATIO: 0.4}, Hypothesis.SLIP_TURNING),
        ({Channel.ADVANCE_RATIO: 0.55, Channel.CURRENT_RATIO: 1.2}, Hypothesis.SLIP_LONGITUDINAL),
        ({Channel.ADVANCE_RATIO: 0.02, Channel.CURRENT_RATIO: 2.6}, Hypothesis.STUCK_ON_OBSTACLE),
        ({Channel.HEADING_Z: 5.0, Channel.ADVANCE_RATIO: 1.0}, Hypothesis.TRACK_ASYMMETRY),
        ({Channel.MARKERS: 3.0}, Hypothesis.MARKER_LOST),
        ({Channel.FAILURE: FAILURE_CODES[Reason.OVERSHOOT]}, Hypothesis.OVERSHOOT),
        ({Channel.FAILURE: FAILURE_CODES[Reason.BLOCKED]}, Hypothesis.STUCK_ON_OBSTACLE),
        ({Channel.FAILURE: FAILURE_CODES[Reason.UNSTABLE_IMAGES]}, Hypothesis.ILLUMINATION_CHANGE),
        ({Channel.ADVANCE_RATIO: 1.02, Channel.MARKERS: 4.0, Channel.HEADING_Z: 0.3}, Hypothesis.NOMINAL),
    ],
)
def test_each_signature_leads_to_its_hypothesis(channels: dict[Channel, float], expected: Hypothesis) -> None:
    weights = after(channels)
    weights = after(channels, weights)
    assert max(weights, key=weights.__getitem__) is expected


def test_good_news_brings_the_nominal_back() -> None:
    weights = after({Channel.TURN_RATIO: 0.3})
    for _ in range(3):
        weights = after({Channel.TURN_RATIO: 1.0, Channel.ADVANCE_RATIO: 1.0}, weights)
    assert weights[Hypothesis.NOMINAL] > 0.8


def test_a_refuted_hypothesis_leaves_its_weight_to_the_others():
    weights = dict.fromkeys(Hypothesis, 0.0) | {Hypothesis.LOCALISATION_OUTLIER: 0.8, Hypothesis.NOMINAL: 0.2}
    rest = without(weights, Hypothesis.LOCALISATION_OUTLIER)
    assert rest[Hypothesis.LOCALISATION_OUTLIER] == 0.0
    assert rest[Hypothesis.NOMINAL] == 1.0
