"""Whatever a case does to its process, its ending says so, and the others do not notice."""

from __future__ import annotations

import os
import signal
from contextlib import closing

import pytest

from executive.record import read_result
from executive.run import app
from proving.engine import CaseClass, run_cases, settle
from proving.engine.server import ForkServer
from proving.engine.supervisor import run_alone

BAD = {
    "segfault": ("sut", "crash"),
    "exit_at_once": ("sut", "crash"),
    "raise_error": ("sut", "error"),
    "hang": ("sut", "hang"),
    "eat_memory": ("sut", "memory"),
    "process_killed": ("sut", "killed"),
    "outer_kill": ("infrastructure", "killed"),
    "fill_disk": ("infrastructure", "disk"),
}


@pytest.fixture
def endings(planted, case):
    """One ending per planted fault and of a good case, run two at a time."""
    cases = [case("good")] + [case(name, name, wall_s=2.0 if name == "hang" else 20.0) for name in BAD]
    return {ending.case.key: ending for ending in run_cases(cases, 2)}


def test_each_bad_case_is_classed_and_the_good_one_does_not_notice(endings):
    assert len(endings) == len(BAD) + 1
    assert {name: (e.kind, e.cause) for name, e in endings.items() if name != "good"} == BAD
    assert (endings["good"].kind, endings["good"].cause) == (CaseClass.OK, "")
    for name, ending in endings.items():  # only what the machine spoilt is begun a second time
        assert ending.attempts == (2 if ending.kind is CaseClass.INFRASTRUCTURE else 1), name

    results = {name: settle(ending) for name, ending in endings.items()}
    assert results["good"].outcome == "reached"
    assert all(results[name].outcome == "error" for name in BAD)
    for name, ending in endings.items():
        assert read_result(ending.case.folder / "result.json") == results[name]
        assert results[name].mission_s >= 20.0, "the record up to the fault is evaluated"
    assert "string_at" in endings["segfault"].detail, "the log shows where it crashed"
    assert "in hang" in (endings["hang"].case.folder / "output.log").read_text()
    assert not (endings["good"].case.folder / "output.log").exists()


@pytest.fixture(scope="module")
def server():
    with ForkServer() as started:
        yield started


def test_a_case_comes_out_as_by_longarm_run(server, case, tmp_path):
    one = case()
    ending = run_alone(server, one)
    alone = app.run(one.file, app.RunOptions(out=tmp_path / "alone", bar=False))
    assert settle(ending).digest == alone.result.digest
    assert (alone.folder / "report.html").is_file()
    assert not (one.folder / "report.html").exists(), "a report per case would take too long"


def test_what_cannot_be_resolved_is_refused_and_not_begun_again(server, case):
    ending = run_alone(server, case(text="sede: 4\n"))
    assert (ending.kind, ending.attempts) == (CaseClass.REFUSED, 1)
    assert 'unknown key "sede"' in ending.detail
    assert settle(ending).outcome == "error"


def test_what_lies_in_the_folder_and_is_not_of_a_run_is_left_alone(server, case):
    one = case()
    one.folder.mkdir(parents=True)
    (one.folder / "notes.txt").write_text("mine")
    (one.folder / "result.json").write_text("of an earlier run")
    assert settle(run_alone(server, one)).outcome == "reached"
    assert (one.folder / "notes.txt").read_text() == "mine"


def test_the_death_of_the_process_that_starts_cases_loses_no_case(case):
    with ForkServer() as server:
        os.kill(server._process.pid, signal.SIGKILL)
        ending = run_alone(server, case())
    assert (ending.kind, ending.cause) == (CaseClass.INFRASTRUCTURE, "start")


def test_a_case_is_taken_only_when_a_slot_is_free(case):
    taken = []

    def some():
        for name in ("a", "b", "c"):
            taken.append(name)
            yield case(name)

    with closing(run_cases(some(), 1)) as endings:
        assert next(endings).case.key == "a"
        assert taken == ["a"]
