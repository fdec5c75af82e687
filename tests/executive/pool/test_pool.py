"""The pool: first-fitted, in proportion, with a memory; and no when it must be no."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from executive.core.types import (
    Outcome,
    Point,
    Reason,
    Segment,
)
from executive.isc import Assessment, hypothesis_names
from executive.pool import (
    Attempt,
    Choice,
    Pool,
    Situation,
    Strategy,
)
from tests.executive.isc.test_prediction import pose

SEGMENT = Segment(Point(0.0, 0.0), Point(1.0, 0.0), on_track_m=0.03, off_track_m=0.25, tolerance_m=0.03)


def strategy(name: str, answers: dict[str, float], **more: object) -> Strategy:
    return replace(
        Strategy(name, f"{name}.", Path(f"{name}.yaml"), answers, reasons={}, cost_s=60.0),
        **more,
    )


def situation(anomaly: str, weight: float = 0.9, y_m: float = 0.0, x_m: float = 0.5) -> Situation:
    weights = {h: (1 - weight) / (len(hypothesis_names()) - 1) for h in hypothesis_names()} | {
        anomaly: weight
    }
    assessment = Assessment(10.0, weights, None, None)
    failure: Outcome[object] = Outcome(Reason.UNEXPECTED)
    return Situation(10.0, failure, assessment, pose(x_m, y_m, 0.0), SEGMENT)


def pool(*strategies: Strategy) -> tuple[Pool, list[Choice | Attempt]]:
    notes: list[Choice | Attempt] = []
    return Pool(strategies, notes.append), notes


TURN = strategy("turn", {"slip_turning": 1.0})
BACK = strategy("back", {"stuck_on_obstacle": 1.0}, excursion_m=0.12)


def test_the_strategy_that_answers_the_likely_hypothesis_is_chosen() -> None:
    chosen, notes = pool(TURN, BACK)
    choice = chosen.choose(situation("stuck_on_obstacle"))
    assert (choice.strategy, choice.hypothesis) == ("back", "stuck_on_obstacle")
    assert choice.weight == pytest.approx(0.9)
    assert notes == [choice]


def test_of_two_that_answer_the_cheaper_goes_first() -> None:
    dear = strategy("dear", {"slip_turning": 1.0}, cost_s=3000.0)
    assert pool(dear, TURN)[0].choose(situation("slip_turning")).strategy == "turn"


def test_what_did_not_help_here_is_not_tried_here_again() -> None:
    chosen, _ = pool(TURN)
    chosen.choose(situation("slip_turning"))
    chosen.conclude(helped=False)
    again = chosen.choose(situation("slip_turning"))
    assert again.strategy is None
    assert again.candidates[0].refused == "did not help here before"


def test_what_did_not_help_here_may_help_elsewhere() -> None:
    chosen, _ = pool(TURN)
    chosen.choose(situation("slip_turning", x_m=0.1))
    chosen.conclude(helped=False)
    assert chosen.choose(situation("slip_turning", x_m=0.8)).strategy == "turn"


def test_tries_on_a_segment_are_limited() -> None:
    chosen, _ = pool(TURN)
    for _ in range(TURN.tries_per_segment):
        assert chosen.choose(situation("slip_turning")).strategy == "turn"
        chosen.conclude(helped=True)
    assert chosen.choose(situation("slip_turning")).strategy is None


def test_beyond_the_off_track_margin_nothing_is_chosen() -> None:
    choice = pool(TURN, BACK)[0].choose(situation("slip_turning", y_m=0.26))
    assert choice.strategy is None
    assert choice.why == "no strategy fits"


def test_a_strategy_that_may_leave_the_margin_is_refused() -> None:
    assert pool(BACK)[0].choose(situation("stuck_on_obstacle", y_m=0.1)).strategy == "back"
    assert pool(BACK)[0].choose(situation("stuck_on_obstacle", y_m=0.2)).strategy is None


def test_a_strategy_that_stays_where_it_is_needs_no_room() -> None:
    unsure = situation("slip_turning")
    unsure = replace(unsure, pose=pose(0.5, 0.0, 0.0, sigma_m=0.2))
    assert pool(TURN)[0].choose(unsure).strategy == "turn"
    creeping = replace(TURN, excursion_m=0.001)
    assert pool(creeping)[0].choose(unsure).strategy is None


def test_a_tie_between_opposed_remedies_calls_home() -> None:
    on = strategy("press_on", {"slip_longitudinal": 1.0}, opposes=frozenset({"back"}))
    back = strategy("back", {"stuck_on_obstacle": 1.0}, opposes=frozenset({"press_on"}))
    torn = situation("stuck_on_obstacle", 0.45)
    weights = dict(torn.assessment.weights) | {"slip_longitudinal": 0.45}
    choice = pool(on, back)[0].choose(replace(torn, assessment=replace(torn.assessment, weights=weights)))
    assert choice.strategy is None
    assert "conflict" in choice.why


def test_unmet_needs_are_given_as_the_reason() -> None:
    needy = replace(TURN, needs=lambda s: "the head is locked")
    choice = pool(needy)[0].choose(situation("slip_turning"))
    assert choice.candidates[0].refused == "the head is locked"


def test_an_unlikely_hypothesis_is_no_reason_to_act() -> None:
    assert pool(TURN)[0].choose(situation("poor_view", 0.99)).strategy is None


def test_what_fails_again_only_further_on_was_helped() -> None:
    chosen, _ = pool(TURN)
    chosen.choose(situation("slip_turning", x_m=0.5))
    chosen.conclude(helped=False, along_m=0.6)
    assert chosen.memory.attempts[-1].helped
    assert chosen.choose(situation("slip_turning", x_m=0.6)).strategy == "turn"


def test_what_this_robot_cannot_carry_out_is_refused_with_its_reason() -> None:
    notes: list[Choice | Attempt] = []
    lacking = "needs cabin, which this robot does not have"
    choice = Pool([TURN], notes.append, unfit={"turn": lacking}).choose(situation("slip_turning"))
    assert choice.strategy is None
    assert choice.candidates[0].refused == lacking
