"""Run with `pytest`: the leaf and the strategy by themselves, on a fake robot; a second for all."""

import math
from pathlib import Path

import pytest
from plugin import LOOK_AGAIN, StandsLevel

from longarm import Bench, check_leaf, check_strategy

TREES = Path(__file__).parents[1] / "trees"


@pytest.mark.parametrize(("tilt_deg", "ok"), [(0.0, True), (19.9, True), (20.1, False)])
def test_the_rover_stands_level_up_to_20_degrees(tilt_deg, ok):
    assert Bench().run(StandsLevel, tilt=math.radians(tilt_deg)).outcome.ok == ok


def test_the_leaf_keeps_what_every_leaf_promises():
    check_leaf(StandsLevel, tilt=0.0)


def test_the_strategy_keeps_what_every_strategy_promises():
    check_strategy(LOOK_AGAIN)


def test_looking_again_takes_five_minutes_and_ends_well():
    bench = Bench(strategies=(LOOK_AGAIN,))
    ended = bench.run_tree(TREES / "look_again.yaml", pose=bench.services.classification.predicted())
    assert ended.outcome.ok
    assert ended.ticks >= 300
