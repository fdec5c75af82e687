"""Proposals for holes: they are found, run, kept, written, and show what they say from their files."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from executive.core import registry
from executive.run.app import RunOptions, run
from executive.run.fault import FAULT_KIND
from proving.coverage.bases import candidates
from proving.coverage.coverage import cover
from proving.coverage.fill import file_name, needed
from proving.coverage.fill_command import fill as command_line
from proving.coverage.items import Item
from proving.coverage.recipes import NEEDED, RECIPES, of_kind, specs
from proving.coverage.search import Proposal


def item(word):
    return Item("node", "trek_to/loop", word)


def proposal(fills, shows=(), wrong=""):
    fault = {"frozen_frame": {}, "name": "frozen", "from": {"time": "0 s"}}
    words = frozenset(map(item, (*fills, *shows)))
    return Proposal({"faults": [fault]}, tuple(map(item, fills)), words, "reached", wrong)


def test_what_others_fill_as_well_is_not_needed():
    first, second, third = proposal("a"), proposal("b", "a"), proposal("c")
    assert needed([first, second, third]) == (second, third)
    assert needed([proposal("a"), proposal("b")]) != ()


def test_a_file_is_named_after_what_it_fills_or_what_broke():
    assert file_name(proposal(["failure"])) == "trek_to_loop_failure"
    assert file_name(proposal(["failure"], wrong="unsafe: x")) == "wrong_frozen_time_0_s"


@pytest.mark.parametrize("word", RECIPES)
def test_every_recipe_fits_the_parameters_of_its_fault(word):
    installed = registry.names(FAULT_KIND)
    by_name = {spec.name: spec for spec in specs()}
    for fault in RECIPES[word]:
        ((kind, parameters),) = fault.items()
        if kind in installed:
            by_name[kind].model.model_validate_json(json.dumps(parameters))


def test_every_installed_fault_can_be_tried():
    for spec in specs():
        made = list(of_kind(spec, ["back_off"]))
        assert made, f"{spec.name} must be told more than {list(NEEDED)}"
        for fault in made:
            spec.model.model_validate_json(json.dumps(fault[spec.name]))


def test_a_hole_that_no_scenario_reaches_has_no_candidate():
    assert list(candidates(item("failure"), [], {})) == []


@pytest.fixture(scope="module")
def filled(suite, tmp_path_factory):
    """What five runs propose for the one scenario without faults."""
    folder = tmp_path_factory.mktemp("filled")
    arguments = [str(suite / "plain.yaml"), "-o", str(folder), "--runs", "5", "-j", "2", "--json"]
    told = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("click.echo", lambda text, **_: told.append(text))
        assert command_line.main(arguments, standalone_mode=False) == 0
    return json.loads(told[0])


def test_scenarios_are_proposed_that_raise_the_coverage(filled):
    assert filled["after"] > filled["before"] > 0
    assert filled["runs"] <= 6
    proposed = [row for row in filled["scenarios"] if not row["wrong"]]
    assert proposed
    assert all(row["fills"] for row in proposed)


def test_a_proposal_run_from_its_file_shows_what_it_says_and_passes(filled, tmp_path):
    row = next(row for row in filled["scenarios"] if not row["wrong"])
    file = Path(row["file"])
    assert file.read_text().startswith("# Proposed by `longarm fill`")
    done = run(file, RunOptions(out=tmp_path / "run", bar=False, report=False))
    assert done.exit_code == 0
    shown = {str(item) for item in cover([tmp_path / "run"]).seen.count}
    assert set(row["fills"]) <= shown
