import pytest

from executive.core.errors import ConfigError
from executive.core.types import Reason
from tests.executive.tree.conftest import ScriptedPool

STRATEGIES = {
    "fix": "tree: fix\nroot: {act: {say: fix, ticks: 1}}",
    "hopeless": "tree: hopeless\nroot: {act: {say: hopeless, reason: blocked}}",
    "remeasure": (
        "tree: remeasure\nports: {depth: {type: length, direction: out}}\nroot: {measure: {value: '{depth}'}}"
    ),
}


def test_a_strategy_is_chosen_by_the_failure_and_the_child_runs_again(bench):
    pool = ScriptedPool("remeasure")
    root = (
        "{recover: {attempts: 3, child: {sequence: [{act: {say: child}}, "
        "{always: {}, failure_if: '{depth} < 0.1 m'}]}}}"
    )
    ports = "{depth: {type: length, direction: inout}}"
    tree = bench.build(root, pool, STRATEGIES, ports, depth=0.0)
    assert bench.run(tree) == "SUCCESS"
    assert [failure.reason for failure in pool.failures] == [Reason.GUARD]
    assert pool.helped == [True]
    assert bench.diary.count("begin child") == 2
    assert tree.store.values["t:depth"] == 0.25


def test_a_strategy_that_changes_nothing_did_not_help(bench):
    pool = ScriptedPool("fix", "fix")
    tree = bench.build("{recover: {attempts: 5, child: {act: {reason: blocked}}}}", pool, STRATEGIES)
    assert bench.run(tree) == "FAILURE"
    assert pool.helped == [False, False]
    path, outcome = tree.trace.last_failure
    assert (path, outcome.reason) == ("t/recover", Reason.NO_STRATEGY)
    assert outcome.detail == "no strategy fits; blocked: as told"


def test_a_strategy_that_fails_itself_gives_way_to_the_next(bench):
    pool = ScriptedPool("hopeless", "fix")
    tree = bench.build("{recover: {attempts: 5, child: {act: {reason: tilt}}}}", pool, STRATEGIES)
    bench.run(tree)
    assert pool.helped == [False, False]
    assert [failure.reason for failure in pool.failures] == [Reason.TILT] * 3


def test_attempts_bound_how_often_the_pool_is_asked(bench):
    pool = ScriptedPool(*["fix"] * 9)
    tree = bench.build("{recover: {attempts: 2, child: {act: {reason: blocked}}}}", pool, STRATEGIES)
    assert bench.run(tree) == "FAILURE"
    assert len(pool.failures) == 2
    assert tree.trace.last_failure[1].detail == "2 attempts used up; blocked: as told"


def test_an_interrupted_strategy_is_halted(bench):
    pool = ScriptedPool("fix")
    tree = bench.build("{recover: {attempts: 2, child: {act: {reason: blocked}}}}", pool, STRATEGIES)
    bench.run(tree, 2)
    assert bench.diary[-1] == "begin fix"
    tree.root.stop()
    assert bench.diary[-1] == "halt fix"


def test_every_strategy_has_its_own_path(bench):
    tree = bench.build("{recover: {attempts: 2, child: act}}", ScriptedPool(), {"fix": STRATEGIES["fix"]})
    assert set(tree.paths) == {"t/recover", "t/recover/act", "t/recover/fix", "t/recover/fix/act"}


def test_a_strategy_that_needs_what_the_tree_lacks_is_not_at_hand(bench):
    needy = {"needy": "tree: needy\nports: {segment: {type: Segment}}\nroot: act", "fix": STRATEGIES["fix"]}
    pool = ScriptedPool()
    tree = bench.build("{recover: {attempts: 2, child: {act: {reason: blocked}}}}", pool, needy)
    assert bench.run(tree) == "FAILURE"
    assert pool.at_hand == [{"fix"}]
    assert "t/recover/needy" not in tree.paths


def test_recover_inside_a_strategy_is_refused(bench):
    nested = {"nested": "tree: nested\nroot: {recover: {attempts: 1, child: act}}"}
    with pytest.raises(ConfigError, match="recover inside a strategy"):
        bench.build("{recover: {attempts: 2, child: act}}", ScriptedPool(), nested)


def test_a_strategys_leaf_finds_what_the_tree_that_recovers_has(bench):
    """Else a pose it measures is of no segment, and a guard on `{pose.cross_track}` fails after it."""
    strategies = {"look": "tree: look\nroot: {note: {}}", "own": "tree: own\nroot: {sequence: [note]}"}
    root = "{recover: {attempts: 2, child: {act: {reason: blocked}}}}"
    ports = "{length: {type: length, direction: in}}"
    tree = bench.build(root, ScriptedPool("look", "own"), strategies, ports, length=0.25)
    bench.run(tree)
    assert [said for said in bench.diary if isinstance(said, float)] == [0.25, 0.25]
