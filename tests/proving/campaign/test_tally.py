"""Counts, intervals, and when enough is known."""

from __future__ import annotations

import itertools
from dataclasses import replace

import pytest
from scipy.stats import binomtest

from executive.record import RunResult
from proving.campaign.interval import wilson
from proving.campaign.shape import StopRule
from proving.campaign.tally import Ended, Tally


def ended(number, verdict="passed", setting=""):
    return Ended(number, setting, 1, verdict, "ok", "", "reached", 2.0, 1.5, "d")


@pytest.mark.parametrize("confidence", [0.8, 0.95, 0.99])
def test_the_interval_is_wilsons(confidence):
    for trials in (1, 7, 100):
        for successes in range(trials + 1):
            known = binomtest(successes, trials).proportion_ci(confidence, "wilson")
            assert wilson(successes, trials, confidence) == pytest.approx((known.low, known.high), abs=1e-12)
    assert wilson(0, 0) == (0.0, 1.0)


def test_enough_is_known_once_the_interval_is_narrow_and_not_before():
    rule, tally = StopRule(interval=0.2), Tally()
    widths = {}
    for number in range(40):
        tally.add(ended(number))
        low, high = wilson(number + 1, number + 1)
        widths[number] = high - low
        assert tally.enough(rule) == (widths[number] < 0.2)
    assert any(width < 0.2 for width in widths.values())
    assert not tally.enough(None)


def test_enough_is_known_at_the_same_case_whatever_the_order_of_ends():
    rule = StopRule(interval=0.7)
    stops = set()
    for order in itertools.permutations(range(5)):
        tally = Tally()
        for number in order:
            tally.add(ended(number))
            if tally.enough(rule):
                break
        stops.add(min(set(range(6)) - set(tally.ended)))
    assert all(stop >= 2 for stop in stops)
    tally = Tally({n: ended(n) for n in (1, 2, 3, 4)})
    assert not tally.enough(rule), "what comes before the first gap counts alone"


def test_every_setting_must_be_known_well_enough():
    tally = Tally({n: ended(n, setting="a" if n < 20 else "b") for n in range(21)})
    assert not tally.enough(StopRule(interval=0.2))
    assert tally.shares()["a"]["good"] == 20


def test_a_journal_line_reads_back():
    case = ended(7, "failed", "half")
    assert Ended.from_json(case.to_json()) == case


def test_the_share_outside_counts_only_cases_that_told_it():
    lost = Ended(1, "", 1, "error", "sut", "hang", "error", 60.0, 0.0, "")
    assert Tally({0: ended(0), 1: lost}).outside_share() == pytest.approx(0.25)
    assert Tally({1: lost}).outside_share() is None


def test_cases_in_which_a_fault_never_fired_are_counted_beside():
    tally = Tally()
    tally.add(ended(0))
    tally.add(replace(ended(1, "invalid"), outcome="invalid", ended_as="reached"))
    tally.add(replace(ended(2, "invalid"), outcome="invalid", ended_as="help"))
    (share,) = tally.shares().values()
    assert (share["good"], share["cases"], share["untested"], share["untested_reached"]) == (1, 1, 2, 1)


def test_an_invalid_run_says_how_it_ended_all_the_same():
    invalid = RunResult(outcome="invalid", reason="hum never took effect; the run ended safe_hold")
    assert invalid.ended_as == "safe_hold"
    assert RunResult(outcome="help", reason="the run ended reached").ended_as == "help"
