"""Selection policies: which of several strategies that may be tried is tried."""

from __future__ import annotations

from dataclasses import replace

import pytest

from executive.pool import DEFAULT_POLICY, FIRST_FITTED, Decision, Policy, Pool, known_policy, policy_names
from executive.pool.known import broken_by_policy
from tests.executive.pool.test_pool import SEGMENT, situation, strategy

CHEAP = strategy("cheap", {"overshoot": 1.0}, cost_s=10.0)
FIT = strategy("fit", {"slip_turning": 1.0}, cost_s=60.0)
WIDE = strategy("wide", {"slip_turning": 1.0}, cost_s=5.0, excursion_m=2.0)
SLIP = situation("slip_turning", 0.95)


def tried(policy: str, times: int = 1) -> list[str | None]:
    pool = Pool((CHEAP, FIT, WIDE), lambda note: None, known_policy(policy))
    return [pool.choose(SLIP).strategy for _ in range(times)]


def test_all_policies_are_registered_with_a_word_about_each() -> None:
    assert set(policy_names()) >= {"first_fitted", "fixed_order", "none", "round_robin"}
    assert known_policy(DEFAULT_POLICY) is FIRST_FITTED
    for name in policy_names():
        assert known_policy(name).name == name
        assert known_policy(name).doc


@pytest.mark.parametrize(
    ("policy", "strategies"),
    [
        ("first_fitted", ["fit", "fit", None]),
        ("fixed_order", ["cheap", "cheap", "fit"]),
        ("round_robin", ["cheap", "fit", "cheap"]),
        ("none", [None, None, None]),
    ],
)
def test_each_policy_tries_in_its_own_order(policy: str, strategies: list[str | None]) -> None:
    assert tried(policy, 3) == strategies


@pytest.mark.parametrize("policy", ["first_fitted", "fixed_order", "round_robin", "none"])
def test_no_policy_leaves_the_margin(policy: str) -> None:
    pool = Pool((WIDE,), lambda note: None, known_policy(policy))
    choice = pool.choose(SLIP)
    assert choice.strategy is None
    assert "may leave the margin" in str(choice.candidates[0].refused)
    beyond = Pool((CHEAP, FIT), lambda note: None, known_policy(policy))
    assert beyond.choose(situation("slip_turning", y_m=SEGMENT.off_track_m)).strategy is None


def test_a_policy_of_ones_own_decides_and_says_why() -> None:
    last = Policy("last", "The least fit.", lambda options, s, memory: Decision(options[-1].strategy, "last"))
    choice = Pool((FIT, replace(FIT, name="dear", cost_s=900.0)), lambda note: None, last).choose(SLIP)
    assert (choice.strategy, choice.why, choice.hypothesis) == ("dear", "last", "slip_turning")


def test_a_broken_policy_is_named_with_its_breaches() -> None:
    broken = Policy("in turn", " ", "by turns")
    assert list(broken_by_policy(broken)) == [
        "got the name 'in turn', expected an identifier",
        "it does not say how it chooses (doc)",
        "it chooses by 'by turns', expected something to call",
    ]
    assert not list(broken_by_policy(FIRST_FITTED))


def test_a_strategy_that_answers_reasons_only_is_tried_against_the_likeliest_anomaly() -> None:
    plain = replace(FIT, answers={}, reasons={SLIP.failure.reason: 0.9})
    choice = Pool((plain,), lambda note: None).choose(SLIP)
    assert (choice.strategy, choice.hypothesis) == ("fit", "slip_turning")
