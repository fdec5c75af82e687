"""Tree mutation: what is changed, what counts as noticed, and what is reported."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from executive.config.source import read_text
from executive.core.errors import ConfigError
from executive.tree.catalogue import node_types
from executive.tree.load import load_tree
from executive.tree.strategies import load_strategies
from proving.mutation.command import mutate as command_line
from proving.mutation.equivalents import Equivalents, read_equivalents
from proving.mutation.mutants import Forest, Mutant, changed, dumped
from proving.mutation.mutate import MutationOptions, chosen, mutate
from proving.mutation.operators import OPERATORS, MutationSite, defaults
from proving.mutation.sites import sites
from proving.mutation.trial import Found

TREE = """\
tree: small
ports: {pose: {type: PoseEstimate, direction: inout}, leg: {type: length, default: 100 mm}}
root:
  sequence:
    - take_picture
    - recover:
        attempts: 4
        child:
          localise: {quality: precise, pose: "{pose}"}
    - wait: {duration: 20 s}
      while: "abs({pose.cross_track}) < 30 mm"
      name: pause
"""


def changes(operator):
    """What an operator makes of the small tree: the words, and the data afterwards."""
    source, types = read_text(TREE, "small.yaml"), node_types()
    scene = MutationSite(source, types, lambda word: {p.name: p for p in types[word].ports})
    found = [c for site in sites(source, types) for c in OPERATORS[operator](scene, site)]
    return {change.what: changed(source, change)["root"]["sequence"] for change in found}


def test_every_node_of_a_file_is_a_place_to_change():
    found = [site.word for site in sites(read_text(TREE, "small.yaml"), node_types())]
    assert found == ["sequence", "take_picture", "recover", "localise", "wait"]


def test_neighbours_are_swapped():
    made = changes("swap_children")
    assert list(made) == ["swap take_picture and recover (1, 2)", "swap recover and pause (2, 3)"]
    assert made["swap take_picture and recover (1, 2)"][1] == "take_picture"


def test_each_child_is_dropped_in_turn():
    made = changes("drop_child")
    assert [len(children) for children in made.values()] == [2, 2, 2]
    assert "take_picture" not in made["drop take_picture (1)"]


def test_leaves_are_inverted_and_a_sequence_becomes_a_selector():
    source, types = read_text(TREE, "small.yaml"), node_types()
    scene = MutationSite(source, types, lambda word: {})
    made = {c.what: c.value for s in sites(source, types) for c in OPERATORS["invert"](scene, s)}
    assert set(made) == {"selector for sequence", "invert take_picture", "invert localise", "invert pause"}
    assert list(made["selector for sequence"]) == ["selector"]
    assert made["invert take_picture"] == {"inverter": {"child": "take_picture"}}


def test_recover_is_dropped_and_its_child_stays():
    made = changes("unwrap")
    assert made["drop recover, keep its child"][1] == {"localise": {"quality": "precise", "pose": "{pose}"}}


def test_a_guard_is_dropped_negated_and_made_generous():
    made = {what: children[2].get("while") for what, children in changes("weaken_guard").items()}
    assert made == {
        "drop while": None,
        "negate while": "not (abs({pose.cross_track}) < 30 mm)",
        "be twice as generous in while": "abs({pose.cross_track}) < 2 * 30 mm",
    }


def test_literals_grow_shrink_or_become_another_word():
    assert set(changes("change_literal")) == {
        "attempts 16 for 4",
        "attempts 1 for 4",
        "quality trend for precise",
        "quality far for precise",
        "duration 80 s for 20 s",
        "duration 5 s for 20 s",
    }
    assert [c.value for c in defaults(read_text(TREE, "small.yaml"))] == ["400 mm", "25 mm"]


@pytest.fixture(scope="module")
def mutants():
    return list(Forest.of("navigate", load_strategies()).mutants())


def test_every_mutant_of_the_shipped_trees_is_one_change_that_loads(mutants):
    assert len(mutants) > 200
    assert len({m.name for m in mutants}) == len(mutants)
    assert {m.operator for m in mutants} == set(OPERATORS)
    assert {m.file.stem for m in mutants} >= {"navigate", "trek_to", "back_off", "wait_for_sight"}
    for mutant in mutants[::20]:
        assert load_tree(mutant.file, instead={mutant.file: mutant.after})
        added = [line for line in mutant.diff().splitlines()[3:] if line[:1] in "+-"]
        assert added


def test_a_mutant_stands_where_coverage_has_its_node(mutants):
    nodes = Forest.of("navigate", load_strategies()).universe.words
    assert {m.node for m in mutants} <= set(nodes)


def test_dumping_a_tree_does_not_change_it():
    data = read_text(TREE, "small.yaml").data
    assert read_text(dumped(data), "again").data == data


def test_a_limit_draws_the_same_mutants_from_the_same_seed():
    forest = Forest.of("find_rover", load_strategies())
    once, again = (chosen(forest, MutationOptions(limit=5, seed=3)) for _ in range(2))
    assert once == again
    assert len(once) == 5
    assert chosen(forest, MutationOptions(limit=5, seed=4)) != once


def test_an_unknown_tree_is_refused_with_a_guess():
    with pytest.raises(ConfigError, match='did you mean "find_rover"'):
        chosen(Forest.of("navigate", load_strategies()), MutationOptions(only=("find_rovr",)))


@pytest.fixture(scope="module")
def score(suite):
    """Every mutant of find_rover before the two scenarios on the fake robot."""
    return mutate("navigate", [suite], MutationOptions(slots=2, only=("find_rover",)), Equivalents())


def by_name(score):
    return {found.mutant.what: found for found in score.found}


def test_a_change_that_costs_the_mission_is_noticed(score):
    found = by_name(score)["invert localise"]
    assert found.killer is not None
    # two scenarios notice it, and with two slots either may be the first
    assert found.why.startswith(("outcome is reached", "invalid: frozen_frame never took effect"))


def test_a_change_that_nothing_asks_for_survives(score):
    found = by_name(score)["attempts 12 for 3"]
    assert (found.killer, found.runs, found.changed) == (None, 2, False)
    assert found in score.survivors


def test_the_score_counts_what_was_noticed(score):
    assert score.ratio == score.killed / len(score.found)
    assert 0 < score.killed < len(score.found)
    assert all(baseline.passed for baseline in score.baselines)
    assert score.per_hour > 0


def test_what_no_scenario_reaches_is_not_run(suite):
    score = mutate("navigate", [suite / "plain.yaml"], MutationOptions(only=("back_off",)), Equivalents())
    assert len(score.found) > 40
    assert {(found.runs, found.why) for found in score.survivors} == {(0, "no scenario reaches it")}


def found(what, killer=None):
    return Found(
        Mutant(Path("t.yaml"), "t/root", "drop_child", what, "a", "b"), killer, "it matters", 1, True
    )


def equivalents(tmp_path, *entries):
    file = tmp_path / "coverage.yaml"
    lines = "".join(f'  - {{mutant: "{entry}", because: it is all the same}}\n' for entry in entries)
    file.write_text(f"coverage: small\nequivalent_mutants:\n{lines}")
    return read_equivalents(file)


def test_an_equivalent_mutant_may_live(tmp_path):
    spared = equivalents(tmp_path, "t/root: drop one*")
    alive = [found("drop one (1)"), found("drop two (2)")]
    assert list(spared.of(f.mutant for f in alive)) == [alive[0].mutant]
    assert spared.problems(alive, complete=True) == []


def test_an_equivalent_mutant_that_is_believed_is_not_tried(suite, tmp_path):
    spared = equivalents(tmp_path, "cabin_reposing/*")
    options = MutationOptions(only=("cabin_reposing",), believe=True)
    score = mutate("navigate", [suite / "plain.yaml"], options, spared)
    assert score.found
    assert {(f.runs, f.why) for f in score.found} == {(0, "not tried")}
    assert score.survivors == []


def test_an_equivalent_mutant_that_is_noticed_is_a_problem(tmp_path):
    (problem,) = equivalents(tmp_path, "*one*").problems([found("drop one (1)", Path("s.yaml"))], True)
    assert problem.line == 3
    assert (
        problem.message == 'got "t/root: drop one (1)", which s.yaml notices (it matters); expected none to'
    )


def test_an_equivalent_mutant_that_is_not_made_is_a_problem_only_if_all_are(tmp_path):
    spared = equivalents(tmp_path, "t/root: drop on (1)")
    (problem,) = spared.problems([found("drop one (1)")], complete=True)
    assert problem.message.endswith('did you mean "t/root: drop one (1)"?')
    assert spared.problems([found("drop one (1)")], complete=False) == []


def test_the_command_fails_below_its_threshold_and_prints_survivors_as_diffs(suite, capsys):
    arguments = ["navigate", str(suite / "plain.yaml"), "--only", "cabin_reposing", "--quiet"]
    code = command_line.main([*arguments, "--min", "85 %"], standalone_mode=False)
    told = capsys.readouterr()
    assert code == 1
    assert "got 0.0% of the mutants noticed, expected at least 85%" in told.err
    assert "survived: cabin_reposing/sequence: drop show_markers (1) (no scenario reaches it)" in told.out
    assert "-  - show_markers: {pose: '{pose}'}" in told.out
    assert command_line.main([*arguments, "--json"], standalone_mode=False) == 0
    data = json.loads(capsys.readouterr().out)
    assert (data["score"], data["killed"], data["survived"]) == (0.0, 0, len(data["mutants"]))
