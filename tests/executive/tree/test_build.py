import pickle

import pytest

from executive.core.errors import ConfigError, NodeRaised
from executive.core.types import (
    Point,
    PoseEstimate,
    Reason,
    Segment,
)

ROUTE = (
    Segment(Point(0, 0), Point(1, 0), 0.03, 0.25, 0.03, 0),
    Segment(Point(1, 0), Point(5, 0), 0.03, 0.25, 0.03, 1),
)


def pose(y=0.0, segment=None):
    estimate = PoseEstimate(0.0, (0.5, y, 0.0), (0, 0, 0, 1), [[0.0] * 6] * 6, "markers")
    return estimate.on(segment)


def test_wait_lasts_its_mission_time(bench):
    tree = bench.build("{wait: {duration: 5 s}}")
    assert bench.run(tree) == "SUCCESS"
    assert bench.services.clock.ticks == 6


@pytest.mark.parametrize(
    ("root", "status"),
    [
        ("{sequence: [act, act]}", "SUCCESS"),
        ("{sequence: [act, {act: {reason: blocked}}, act]}", "FAILURE"),
        ("{selector: [{act: {reason: blocked}}, act]}", "SUCCESS"),
        ("{inverter: {act: {reason: blocked}}}", "SUCCESS"),
        ("{force_success: {act: {reason: blocked}}}", "SUCCESS"),
        ("{force_failure: act}", "FAILURE"),
        ("{retry: {attempts: 3, child: {act: {reason: blocked}}}}", "FAILURE"),
        ("{repeat: {times: 3, child: act}}", "SUCCESS"),
        ("{repeat: {child: act}}", "RUNNING"),
        ("{parallel: {policy: one, children: [act, {act: {ticks: 5}}]}}", "SUCCESS"),
        ("{parallel: [act, {act: {reason: blocked}}]}", "FAILURE"),
    ],
)
def test_composites_and_decorators_are_those_of_py_trees(bench, root, status):
    assert bench.run(bench.build(root)) == status


def test_memory_decides_where_a_sequence_goes_on(bench):
    children = "[{act: {say: first}}, {act: {ticks: 2, say: second}}]"
    bench.run(bench.build(f"{{sequence: {{memory: true, children: {children}}}}}"))
    assert bench.diary.count("begin first") == 1
    bench.run(bench.build(f"{{sequence: {{memory: false, children: {children}}}}}"))
    assert bench.diary.count("begin first") == 3


def test_for_each_gives_each_item_in_order(bench):
    root = "{for_each: {in: '{route}', as: segment, child: {visit: {target: '{segment.end}'}}}}"
    tree = bench.build(root, ports="{route: {type: Route}}", route=ROUTE)
    assert bench.run(tree) == "SUCCESS"
    assert bench.diary == [(Point(1, 0), 0), (Point(5, 0), 1)]


def test_for_each_of_nothing_succeeds_without_its_child(bench):
    root = "{for_each: {in: '{route}', as: segment, child: act}}"
    tree = bench.build(root, ports="{route: {type: Route}}", route=())
    assert bench.run(tree) == "SUCCESS"
    assert bench.diary == []


def test_timeout_halts_its_child_and_says_why(bench):
    tree = bench.build("{timeout: {after: 3 s, child: {act: {ticks: 10}}}}")
    assert bench.run(tree) == "FAILURE"
    assert bench.services.clock.ticks == 4
    assert bench.diary == ["begin act", "halt act"]
    assert tree.trace.last_failure[1].reason is Reason.TIMEOUT


def test_while_halts_its_node_and_fails_with_the_expression(bench):
    root = '{act: {ticks: 10}, while: "abs({pose.cross_track}) < {segment.off_track}"}'
    ports = "{pose: {type: PoseEstimate}, segment: {type: Segment}}"
    tree = bench.build(root, ports=ports, pose=pose(0.1, ROUTE[0]), segment=ROUTE[0])
    assert bench.run(tree, 3) == "RUNNING"
    tree.store.values["t:pose"] = pose(0.3, ROUTE[0])
    assert bench.run(tree, 1) == "FAILURE"
    assert bench.diary == ["begin act", "halt act"]
    path, outcome = tree.trace.last_failure
    assert (path, outcome.reason) == ("t/act", Reason.GUARD)
    assert outcome.detail == "while abs({pose.cross_track}) < {segment.off_track}"


@pytest.mark.parametrize(
    ("guard", "status"),
    [("skip_if", "SUCCESS"), ("success_if", "SUCCESS"), ("failure_if", "FAILURE"), ("while", "FAILURE")],
)
def test_a_guard_that_cannot_be_decided_never_lets_a_node_go_on(bench, guard, status):
    root = f'{{sequence: [{{act: {{}}, {guard}: "{{pose.cross_track}} < 0 m"}}]}}'
    tree = bench.build(root, ports="{pose: {type: PoseEstimate}}", pose=pose())
    assert bench.run(tree) == status
    assert bench.diary == ([] if status == "FAILURE" else ["begin act", "halt act"])


def test_a_skipped_child_counts_as_success_in_a_sequence_and_failure_in_a_selector(bench):
    skipped = "{act: {say: skipped}, skip_if: 'true'}"
    assert bench.run(bench.build(f"{{sequence: [{skipped}, {{act: {{say: next}}}}]}}")) == "SUCCESS"
    assert bench.diary == ["begin next", "halt next"]
    assert bench.run(bench.build(f"{{selector: [{skipped}]}}")) == "FAILURE"
    assert bench.run(bench.build(f"{{parallel: [{skipped}]}}")) == "SUCCESS"
    assert bench.diary == []


def test_failure_if_fails_on_entry_and_success_if_succeeds(bench):
    assert bench.run(bench.build("{act: {reason: blocked}, success_if: 'true'}")) == "SUCCESS"
    assert bench.run(bench.build("{act: {}, failure_if: 'true'}")) == "FAILURE"
    assert bench.diary == []


def test_a_sub_tree_writes_into_the_slot_it_was_given(bench, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "trees").mkdir()
    (tmp_path / "trees" / "inner.yaml").write_text(
        "tree: inner\nports: {depth: {type: length, direction: out}, extra: {type: length, default: 2 m}}\n"
        "root: {sequence: [{measure: {value: '{depth}'}}, {note: {value: '{extra}'}}]}\n"
    )
    tree = bench.build("{sequence: [{inner: {depth: '{d}'}}, {note: {value: '{d}'}}, {inner: {}}]}")
    assert bench.run(tree) == "SUCCESS"
    assert bench.diary == [2.0, 0.25, 2.0]
    assert tree.store.values["t:d"] == 0.25
    assert "t/sequence/inner/sequence/measure" in tree.paths


def test_a_port_defaults_to_the_trees_value_of_that_name(bench):
    bench.run(bench.build("note", ports="{length: {type: length}}", length=4.0))
    assert bench.diary == [4.0]
    bench.run(bench.build("note"))
    assert bench.diary == [None]


def test_two_trees_do_not_share_a_value(bench):
    ports = "{length: {type: length}}"
    first = bench.build("note", ports=ports, length=1.0)
    second = bench.build("note", ports=ports, length=2.0)
    bench.run(first)
    assert (first.store.values, second.store.values) == ({"t:length": 1.0}, {"t:length": 2.0})
    assert pickle.loads(pickle.dumps(first.store)).values == first.store.values


def test_missing_and_unknown_inputs_are_refused(bench):
    with pytest.raises(ConfigError) as caught:
        bench.build("act", ports="{length: {type: length}}", lenth=1.0)
    assert len(caught.value.problems) == 2


@pytest.mark.parametrize("at_tick", [0, 1, 9])
@pytest.mark.parametrize(
    "root",
    [
        "{parallel: [{act: {ticks: 20, say: drive}}, RAISE]}",
        "{parallel: [RAISE, {act: {ticks: 20, say: drive}}]}",
        "{sequence: [{parallel: [{act: {ticks: 20, say: drive}}, {sequence: [RAISE]}]}]}",
        "{timeout: {after: 1 min, child: {parallel: [{act: {ticks: 20, say: drive}}, RAISE]}}}",
        "{recover: {attempts: 2, child: {parallel: [{act: {ticks: 20, say: drive}}, RAISE]}}}",
        "{parallel: [{act: {ticks: 20, say: drive}}, {act: {ticks: TICKS, reason: raise}, while: 'true'}]}",
    ],
)
def test_a_leaf_that_raises_leaves_nothing_running_once_terminated(bench, root, at_tick):
    root = root.replace("RAISE", f"{{act: {{ticks: {at_tick}, reason: raise}}}}").replace(
        "TICKS", str(at_tick)
    )
    tree = bench.build(root)
    with pytest.raises(NodeRaised, match=r"^t/\S*act\S*: ValueError: broken"):
        bench.run(tree)
    tree.trace.terminate_entered()
    begun = sorted(line.split()[1] for line in bench.diary if line.startswith("begin"))
    assert sorted(line.split()[1] for line in bench.diary if line.startswith("halt")) == begun
    assert tree.trace.entered == {}


def test_an_interrupted_tree_halts_every_leaf_once(bench):
    tree = bench.build("{parallel: [{act: {ticks: 20, say: a}}, {sequence: [{act: {ticks: 20, say: b}}]}]}")
    bench.run(tree, 2)
    tree.trace.terminate_entered()
    tree.trace.terminate_entered()
    assert sorted(bench.diary) == ["begin a", "begin b", "halt a", "halt b"]
