"""Trials that go from case to case, and what counts as worse between two runs of a scenario."""

from __future__ import annotations

from pathlib import Path

import pytest

from executive.record import RunResult
from executive.tree.load import load_tree
from proving.coverage.trials import conduct
from proving.engine import Case, CaseClass, Ending, run_cases, settle
from proving.judge.verdict import Terms, Verdict, Word
from proving.mutation.account import Account, account


def test_a_tree_file_can_be_taken_to_say_something_else(suite, tmp_path):
    path = str(Path(load_tree("find_rover").file).absolute())
    blind = "tree: find_rover\nports: {pose: {type: PoseEstimate, direction: inout}}\nroot: {oops: {}}\n"
    other = blind.replace("{oops: {}}", "{force_failure: {take_picture: {}}}")
    cases = [
        Case(name, suite / "plain.yaml", tmp_path / name, instead={path: text})
        for name, text in (("wrong", blind), ("right", other))
    ]
    ends = {ending.case.key: ending for ending in run_cases(cases, 2)}
    assert ends["wrong"].kind is CaseClass.REFUSED
    assert settle(ends["right"]).outcome == "help"


def test_trials_take_turns_and_decide_what_comes_next():
    def run(cases, slots):
        for case in iter(lambda: next(cases, None), None):
            yield Ending(case, CaseClass.OK, detail=case.key)

    def trial(name, rounds):
        seen = []
        for number in range(rounds):
            ending = yield Case(f"{name}{number}", None, None)
            seen.append(ending.detail)
        return seen

    found = list(conduct([trial("a", 3), trial("none", 0), trial("b", 1)], 2, run))
    assert sorted(found) == [[], ["a0", "a1", "a2"], ["b0"]]


def told(word="passed", met=("a", "b"), missed=()):
    return Account(Verdict(Word(word), "why"), frozenset(met), missed, RunResult())


@pytest.mark.parametrize(
    ("after", "lost"),
    [
        (told(), None),
        (told("failed", ("a",), ("b",)), "b"),
        (told(met=("a",)), "b"),
        (told("failed"), "failed: why"),
        (told("error", ()), "error: why"),
        (told("invalid"), "invalid: why"),
        (told(met=("a", "b", "c")), None),
        (told(missed=("c",)), None),
    ],
)
def test_a_run_is_worse_when_something_that_held_no_longer_does(after, lost):
    assert after.lost(told()) == lost


def test_what_failed_before_may_fail_again():
    before = told("failed", ("a",), ("b",))
    assert told("failed", ("a",), ("b",)).lost(before) is None
    assert told("failed", (), ("a", "b")).lost(before) == "a"


def test_two_runs_of_a_scenario_give_the_same_account(suite, tmp_path):
    cases = [Case(name, suite / "plain.yaml", tmp_path / name) for name in ("one", "two")]
    one, two = (account(ending, Terms()) for ending in run_cases(cases, 2))
    assert one == two
    assert "outcome is reached" in one.met
