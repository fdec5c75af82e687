"""The checkers of hypotheses, channels and strategies name each promise that is broken."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from executive.isc import Categorical, Channel, Gaussian, Hypothesis, Measured
from executive.pool import Strategy
from executive.testing import check_channel, check_hypothesis, check_strategy
from executive.testing.check_diagnosis import DiagnosisBreach
from executive.testing.check_strategy import StrategyBreach

SLACK = Hypothesis("slack", "A belt is slack.", {"advance_ratio": Gaussian(0.8, 0.1)})
SPEED = Channel("speed", "Of the rover.", "m/s", Gaussian(0.001, 0.0005), lambda seen: Measured(0.001))


def test_sound_plug_ins_pass() -> None:
    check_hypothesis(SLACK)
    check_channel(SPEED)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"name": "not a name"}, "got the name 'not a name', expected an identifier"),
        ({"name": "nominal"}, "which the classification brings itself"),
        ({"doc": " "}, "does not say what it is"),
        ({"prior": 0.0}, "got the prior 0.0, expected more than 0"),
        ({"signature": {}}, "it says nothing on any channel"),
        ({"signature": {"advance": Gaussian(1.0, 0.1)}}, "it speaks about 'advance', expected a channel"),
        ({"signature": {"advance_ratio": Gaussian(1.0, 0.0)}}, "a sigma above 0"),
        ({"signature": {"advance_ratio": Gaussian(1.0, 0.1, floor=9.0)}}, "got the floor 9.0"),
        (
            {"signature": {"advance_ratio": Categorical(frozenset({1.0}), 0.5, 0.5)}},
            "on advance_ratio: got a Categorical, expected a Gaussian",
        ),
        ({"signature": {"failure": Categorical(frozenset(), 0.5, 0.5)}}, "got no values inside"),
        ({"signature": {"failure": Categorical(frozenset({"x"}), 1.5, 0.5)}}, "expected both in"),
    ],
)
def test_a_broken_hypothesis_is_named_with_its_breach(change: dict[str, object], message: str) -> None:
    with pytest.raises(DiagnosisBreach, match=message):
        check_hypothesis(replace(SLACK, **change))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"name": "1st"}, "expected an identifier"),
        ({"observe": None}, "expected something to call"),
        ({"observe": lambda seen: seen.fix.markers}, "observing a fix gave 4, expected a Measured or None"),
        ({"observe": lambda seen: seen.battery}, "observing a fix raised AttributeError"),
        ({"nominal": Gaussian(float("nan"), 1.0)}, "when all is well: got"),
    ],
)
def test_a_broken_channel_is_named_with_its_breach(change: dict[str, object], message: str) -> None:
    with pytest.raises(DiagnosisBreach, match=message):
        check_channel(replace(SPEED, **change))


def test_a_strategy_for_an_unknown_hypothesis_is_named_with_a_guess(tmp_path: Path) -> None:
    tree = tmp_path / "look.yaml"
    tree.write_text("tree: look\nroot: always\n")
    look = Strategy("look", "Look.", tree, {"marker_lots": 1.0}, {}, cost_s=10.0)
    with pytest.raises(
        StrategyBreach, match="look: it answers the unknown hypothesis 'marker_lots'; did you"
    ):
        check_strategy(look)
    check_strategy(replace(look, answers={"marker_lost": 1.0}))
