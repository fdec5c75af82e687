"""One word and one line about a run."""

from __future__ import annotations

from pathlib import Path

import pytest

from executive.record import RunResult
from executive.record.rows import JudgedRow
from proving.engine import Case, CaseClass, Ending
from proving.judge.verdict import Terms, Word, judged, repeat_command

CASE = Case("short", Path("short.yaml"), Path("out"), seed=3, overrides=("world.advance=0.9",))
OK = Ending(CASE, CaseClass.OK)


def result(outcome="reached", expectations=(), reason=None, **more):
    return RunResult(
        outcome=outcome, reason=reason, mission_s=600.0, expectations=tuple(expectations), **more
    )


def row(text="final_error below 30 mm", met=False, **more):
    return JudgedRow(text, met, **more)


def test_reaching_the_goal_passes_where_nothing_is_expected():
    assert judged(OK, result(), Terms()).word is Word.PASSED
    verdict = judged(OK, result("help", reason="blocked: a rock"), Terms())
    assert (verdict.word, verdict.message) == (Word.FAILED, "ended help at 600 s, blocked: a rock")


def test_expectations_decide_where_there_are_any():
    assert judged(OK, result("help", [row("outcome is help", True)]), Terms()).word is Word.PASSED
    assert judged(OK, result("reached", [row()]), Terms()).word is Word.FAILED


def test_the_message_names_the_first_violation_and_when():
    rows = [
        row("outcome is reached", met=False),
        row("tilt", t_violation_s=400.0, robustness=-0.0123),
        row("tether", t_violation_s=90.0),
    ]
    verdict = judged(OK, result("help", rows, "blocked: a rock"), Terms())
    assert verdict.message == "tether: not met at 90 s; ended help, blocked: a rock"
    assert "robustness -0.0123" in judged(OK, result(expectations=rows[1:2]), Terms()).message


def test_a_fault_that_never_fired_is_invalid_whatever_else_holds():
    told = result("invalid", [row(met=True)], "led_off never took effect")
    assert judged(OK, told, Terms()).word is Word.INVALID
    assert judged(OK, told, Terms(expected_to_fail="later")).word is Word.INVALID


def test_an_expected_failure_must_come():
    terms = Terms(expected_to_fail="the pool cannot do it yet")
    assert judged(OK, result(expectations=[row()]), terms).word is Word.EXPECTED_FAILURE
    verdict = judged(OK, result(expectations=[row(met=True)]), terms)
    assert verdict.word is Word.FAILED
    assert "expected to fail: the pool cannot do it yet" in verdict.message


@pytest.mark.parametrize("terms", [Terms(), Terms(expected_to_fail="later")])
def test_safety_holds_for_every_scenario(terms):
    told = result(expectations=[row()], safety=[row("never beyond the margin", False, t_violation_s=12.0)])
    verdict = judged(OK, told, terms)
    assert verdict.word is Word.FAILED
    assert verdict.message.startswith("unsafe: never beyond the margin: not met at 12 s")


def test_safety_that_is_not_known_is_not_broken():
    assert judged(OK, result(safety=[row("never beyond the margin", None)]), Terms()).word is Word.PASSED


def test_an_error_passes_only_where_it_is_expected():
    crash = Ending(CASE, CaseClass.SUT, "crash", "SIGSEGV\n  in f")
    rows = [row("outcome is error", True)]
    assert judged(crash, result("error", rows), Terms()).message == "crash: SIGSEGV in f"
    assert judged(crash, result("error", rows), Terms()).word is Word.ERROR
    assert judged(crash, result("error", rows), Terms(error_expected=True)).word is Word.PASSED


def test_what_the_machine_did_is_an_error_even_where_one_is_expected():
    killed = Ending(CASE, CaseClass.INFRASTRUCTURE, "killed", "SIGKILL from outside")
    verdict = judged(killed, result("error", [row("outcome is error", True)]), Terms(error_expected=True))
    assert (verdict.word, verdict.message) == (Word.ERROR, "infrastructure, killed: SIGKILL from outside")


def test_the_command_that_repeats_a_case_can_be_pasted():
    assert repeat_command(CASE, 3) == "longarm run short.yaml --seed 3 --set world.advance=0.9"
