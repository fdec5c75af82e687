"""Weights: evidence moves them, silence does not, and they come back."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from executive.isc import Channel, Concern, Evidence, Gaussian, Hypothesis, HypothesisBank, Measured
from tests.executive.isc.made_up import BLUE, CHANNELS, HYPOTHESES, LENGTH, LONG, SILENT, evidences

BANK = HypothesisBank(HYPOTHESES, CHANNELS)
LIKE_LONG = Evidence(0.0, {"length": Measured(5.0)})


def ratios(weights: dict[str, float]) -> dict[str, float]:
    return {name: weights[name] / weights["nominal"] for name in ("long", "thin", "blue")}


@given(st.lists(evidences(), max_size=4))
def test_weights_sum_to_one_after_any_evidence(checks: list[Evidence]) -> None:
    weights = dict(BANK.prior)
    for evidence in checks:
        weights = BANK.weigh(weights, evidence)
    assert sum(weights.values()) == pytest.approx(1.0)
    assert all(0.0 <= weight <= 1.0 for weight in weights.values())


@given(evidences())
def test_the_order_of_channels_does_not_matter(evidence: Evidence) -> None:
    turned = Evidence(0.0, dict(reversed(evidence.channels.items())))
    assert BANK.weigh(BANK.prior, turned) == pytest.approx(BANK.weigh(BANK.prior, evidence))


@given(evidences())
def test_a_channel_that_none_is_read_from_changes_nothing(evidence: Evidence) -> None:
    other = Channel("other", "Never there.", "", Gaussian(0.0, 1.0), lambda seen: None)
    speaking = Hypothesis("long", LONG.doc, {**LONG.signature, "other": Gaussian(9.0, 1.0)})
    bank = HypothesisBank((speaking, *HYPOTHESES[1:]), (*CHANNELS, other))
    assert bank.weigh(bank.prior, evidence) == pytest.approx(BANK.weigh(BANK.prior, evidence))


@given(evidences())
def test_a_hypothesis_that_shows_as_nominal_keeps_the_ratios_of_others(evidence: Evidence) -> None:
    bank = HypothesisBank((*HYPOTHESES, SILENT), CHANNELS)
    before, after = BANK.weigh(BANK.prior, evidence), bank.weigh(bank.prior, evidence)
    share = sum(h.prior for h in HYPOTHESES) / sum(h.prior for h in (*HYPOTHESES, SILENT))
    assert ratios(after) == pytest.approx({name: share * ratio for name, ratio in ratios(before).items()})
    assert after["silent"] / after["nominal"] == pytest.approx(bank.prior["silent"] / bank.prior["nominal"])


def test_nominal_keeps_its_share_and_the_others_divide_theirs() -> None:
    assert BANK.prior == pytest.approx({"nominal": 0.8, "long": 0.05, "thin": 0.05, "blue": 0.1})
    more = HypothesisBank((*HYPOTHESES, SILENT), CHANNELS).prior
    assert more["nominal"] == 0.8
    assert sum(more.values()) == pytest.approx(1.0)


def test_no_evidence_leaves_the_prior() -> None:
    assert BANK.weigh(BANK.prior, Evidence(0.0, {})) == pytest.approx(BANK.prior)


def test_evidence_speaks_for_the_hypothesis_that_predicts_it() -> None:
    weights = BANK.weigh(BANK.prior, LIKE_LONG)
    assert max(weights, key=weights.__getitem__) == "long"


def test_good_news_brings_the_nominal_back() -> None:
    weights = BANK.weigh(BANK.prior, LIKE_LONG)
    for _ in range(3):
        weights = BANK.weigh(weights, Evidence(0.0, {"length": Measured(0.0)}))
    assert weights["nominal"] > 0.8


@pytest.mark.parametrize("observed", [None, Measured(math.nan), Measured(math.inf)])
def test_a_channel_without_a_number_is_no_evidence(observed: Measured[float] | None) -> None:
    silent = Channel("length", "A number.", "m", LENGTH.nominal, lambda seen: observed)
    seen = HypothesisBank((LONG,), (silent,)).observe(_Comparison())
    assert seen.channels == {}


class _Comparison:
    time_s = 1.0


def test_a_refuted_concern_leaves_its_weight_to_the_others() -> None:
    false = Hypothesis("false", "The fix is false.", {"length": Gaussian(9.0, 1.0)}, concerns=Concern.FIX)
    bank = HypothesisBank((LONG, false), CHANNELS)
    rest = bank.without({"nominal": 0.2, "long": 0.0, "false": 0.8}, Concern.FIX)
    assert rest == {"nominal": 1.0, "long": 0.0, "false": 0.0}


def test_two_hypotheses_of_one_name_are_refused() -> None:
    with pytest.raises(ValueError, match="different hypotheses"):
        HypothesisBank((BLUE, BLUE), CHANNELS)
    with pytest.raises(ValueError, match="beside nominal"):
        HypothesisBank((), CHANNELS)
    with pytest.raises(ValueError, match="different channels"):
        HypothesisBank((BLUE,), (LENGTH, LENGTH))
