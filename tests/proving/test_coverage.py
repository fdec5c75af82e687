"""Coverage: what there is to cover, what records show of it, excuses, and the verdict."""

from __future__ import annotations

import json

import pytest

from executive.cli import invoke
from executive.core.errors import ConfigError, RecordError
from executive.record import events
from executive.record.history import At
from executive.tree.catalogue import node_types
from executive.tree.load import load_tree_text
from proving.coverage.command import coverage as command_line
from proving.coverage.coverage import cover
from proving.coverage.drawing import page
from proving.coverage.items import Item
from proving.coverage.seen import Seen
from proving.coverage.universe import Universe

TREE = """\
tree: small
ports: {pose: {type: PoseEstimate, direction: inout}, near: {type: Point}}
root:
  sequence:
"""


def universe(nodes):
    made = Universe()
    made.add(load_tree_text(f"{TREE}    - {nodes}\n"), {})
    return {name.removeprefix("small/sequence"): words for name, words in made.words.items()}


def node(name, word):
    return Item("node", name, word)


class Told:
    """A history of node changes."""

    def __init__(self, *changes):
        self.changes = [At(float(i), events.NodeChange(*change)) for i, change in enumerate(changes)]

    def all(self, kind):
        start = events.Start("s", "mission: {tree: small}", 1, 1.0)
        return {events.NodeChange: self.changes, events.Start: [At(0.0, start)]}.get(kind, [])

    def last(self, kind):
        return self.all(kind)[-1]


def test_a_question_can_neither_run_nor_be_halted():
    words = universe("facing: {target: '{near}', pose: '{pose}'}")
    assert words == {"": ["success", "failure"], "/facing": ["success", "off_heading"]}


def test_a_leaf_that_takes_time_runs_and_is_halted_only_where_something_may_cut_it_short():
    assert universe("wait: {duration: 5 s}")["/wait"] == ["success", "device", "running"]
    cut = universe("timeout: {after: 3 s, child: {wait: {duration: 5 s}}}")
    assert cut["/timeout/wait"] == ["success", "device", "running", "halted"]
    assert cut["/timeout"] == ["success", "failure", "running"]


def test_a_while_guard_halts_what_is_inside_and_is_an_outcome_of_its_own():
    words = universe('sequence: [wait: {duration: 5 s}]\n      while: "abs({pose.cross_track}) < 1 m"')
    assert words["/sequence"] == ["success", "failure", "guard", "running"]
    assert words["/sequence/wait"] == ["success", "device", "running", "halted"]


@pytest.mark.parametrize(
    ("outer", "words"),
    [
        ("inverter: {facing: {target: '{near}', pose: '{pose}'}}", ["success", "failure"]),
        ("force_success: {facing: {target: '{near}', pose: '{pose}'}}", ["success"]),
        ("force_failure: {wait: {duration: 5 s}}", ["failure", "running"]),
        ("inverter: {wait: {duration: 5 s}}", ["success", "failure", "running"]),
        ("retry: {attempts: 2, child: {facing: {target: '{near}', pose: '{pose}'}}}",
         ["success", "failure", "running"]),
        ("selector: [wait: {duration: 5 s}, call_for_help: {}]", ["success", "failure", "running"]),
        ("parallel: {policy: one, children: [wait: {duration: 5 s}, watch_motion: {}]}",
         ["success", "failure", "running"]),
    ],
)  # fmt: skip
def test_what_a_node_can_end_as_follows_from_what_is_inside(outer, words):
    assert universe(outer)["/" + outer.split(":")[0]] == words


@pytest.mark.parametrize("name", ["wait", "localise", "drive_leg"])
def test_a_leaf_that_may_return_none_takes_time(name):
    assert node_types()[name].leaf.takes_time()


@pytest.mark.parametrize("name", ["facing", "arrived", "set_leg", "as_predicted"])
def test_a_leaf_that_always_returns_an_outcome_takes_none(name):
    assert not node_types()[name].leaf.takes_time()


def test_halted_is_running_and_then_idle_not_done_and_then_idle():
    made = Universe()
    made.add(load_tree_text(TREE + "    - timeout: {after: 3 s, child: {wait: {duration: 5 s}}}\n"), {})
    path, seen = "small/sequence/timeout/wait", Seen()
    seen.add("first", Told((path, "running"), (path, "success"), (path, "invalid")), made)
    assert node(path, "halted") not in seen.count
    seen.add("second", Told((path, "running"), (path, "invalid")), made)
    assert (seen.count[node(path, "halted")], seen.first[node(path, "halted")]) == (1, "second")


def test_a_reason_that_a_leaf_does_not_declare_is_told():
    made, seen = Universe(), Seen()
    made.add(load_tree_text(TREE + "    - wait: {duration: 5 s}\n"), {})
    seen.add("run", Told(("small/sequence/wait", "failure", "tilt")), made)
    assert list(seen.undeclared) == [node("small/sequence/wait", "tilt")]


def test_a_shared_tree_is_covered_wherever_it_stands(runs):
    coverage = cover([runs])
    facing = [item for item in coverage.items if item.name.endswith("face_the_target/facing")]
    assert {item.word for item in facing} == {"success", "off_heading"}
    inside = {item.name for item in coverage.items if item.name.startswith("rotate_towards/")}
    assert "rotate_towards/loop/facing" in inside
    assert not any("trek_to" in name for name in inside)


def test_the_records_alone_say_what_a_suite_has_shown(runs):
    coverage = cover([runs])
    shown = {item for item in coverage.items if coverage.covers(item)}
    assert node("trek_to/loop/sequence/localise", "success") in shown
    assert node("trek_to/loop/sequence/parallel/watch_motion", "halted") in shown
    assert Item("strategy", "cabin_reposing", "chosen") in shown
    assert Item("fault", "frozen_frame", "fired") in shown
    assert Item("hypothesis", "lost_rover", "led") in shown
    assert {Item("phase", p, "entered") for p in ("turning", "driving", "localising", "recovering")} <= shown
    assert Item("phase", "calling", "entered") not in shown
    assert not coverage.seen.undeclared
    assert not coverage.seen.strangers


def test_one_run_alone_shows_less(runs):
    plain, both = cover([runs / "plain"]), cover([runs])
    assert plain.share().ratio < both.share().ratio
    assert Item("fault", "frozen_frame", "fired") in plain.holes("fault")


def excuses(tmp_path, entries):
    file = tmp_path / "coverage.yaml"
    file.write_text("coverage: short\ncannot_happen:\n" + entries)
    return file


def test_an_excused_hole_is_no_hole(runs, tmp_path):
    file = excuses(
        tmp_path, "  - {node: '*/localise', outcomes: [device], because: the fake never refuses}\n"
    )
    before, after = cover([runs]), cover([runs], file)
    assert after.problems == ()
    localise = [i for i in before.holes() if i.word == "device" and i.name.endswith("/localise")]
    assert len(before.holes()) - len(after.holes()) == len(localise) > 1
    assert after.share().of == before.share().of - len(localise)


def test_an_excuse_for_what_happened_is_a_problem(runs, tmp_path):
    file = excuses(tmp_path, "  - {fault: frozen_frame, because: nobody would freeze a frame}\n")
    (problem,) = cover([runs], file).problems
    assert (problem.line, problem.column) == (3, 5)
    assert problem.message.startswith("got fault frozen_frame: fired, which happened in ")


def test_an_excuse_about_nothing_is_a_problem_with_a_guess(runs, tmp_path):
    file = excuses(
        tmp_path,
        "  - {fault: frozen_fram, because: a typing mistake}\n"
        "  - {node: '*/find_rover', outcomes: [halt], because: a typing mistake}\n",
    )
    first, second = cover([runs], file).problems
    assert first.message.endswith('did you mean "frozen_frame"?')
    assert second.message == 'got the outcome "halt" of */find_rover, expected failure, running or success'


def test_a_bad_file_of_excuses_tells_everything_at_once(runs, tmp_path):
    file = excuses(tmp_path, "  - {because: nothing is named}\n  - {phase: driving, because: short}\n")
    with pytest.raises(ConfigError) as caught:
        cover([runs], file)
    first, second = caught.value.problems
    assert (first.line, second.line) == (3, 4)
    assert first.message == "got none, expected exactly one of node, strategy, phase, fault or hypothesis"


def test_a_file_of_excuses_is_checked_and_has_a_schema(tmp_path, capsys):
    file = excuses(tmp_path, "  - {node: '*', becuase: a typing mistake}\n")
    assert invoke(["check", str(file)]) == 1
    assert 'did you mean "because"?' in capsys.readouterr().out
    assert invoke(["schema", "coverage"]) == 0
    assert "cannot_happen" in json.loads(capsys.readouterr().out)["properties"]


def test_a_folder_without_runs_is_named(tmp_path):
    with pytest.raises(RecordError, match="expected a run folder"):
        cover([tmp_path])


def command(capsys, *arguments):
    code = command_line.main([str(a) for a in arguments], standalone_mode=False)
    told = capsys.readouterr()
    return code, told.out, told.err


def test_the_threshold_fails_what_is_below_it(runs, capsys):
    ratio = cover([runs]).share().ratio
    assert command(capsys, runs, "--min", f"{ratio - 0.01:.3f}")[0] == 0
    code, _, told = command(capsys, runs, "--min", f"{100 * ratio + 1:.1f} %")
    assert code == 1
    assert f"got a coverage of {ratio:.1%}, expected at least" in told


@pytest.mark.parametrize("least", ["much", "130 %", "90 m"])
def test_a_threshold_that_is_no_share_is_refused(runs, least):
    with pytest.raises(ConfigError, match="--min:1:1: got "):
        command_line.main([str(runs), "--min", least], standalone_mode=False)


def test_text_and_json_agree(runs, capsys):
    _, text, _ = command(capsys, runs)
    _, printed, _ = command(capsys, runs, "--json")
    data = json.loads(printed)
    total = data["total"]
    assert text.startswith(f"coverage {total['ratio']:.1%} ({total['covered']} of {total['of']}) by 2 runs")
    missing = [item for item in data["items"] if not item["count"]]
    assert len(missing) == total["of"] - total["covered"]
    assert all(item["name"] in text for item in missing)


def test_the_drawing_shows_every_tree_with_its_outcomes(runs, tmp_path):
    coverage = cover([runs])
    drawn = page(coverage)
    for tree in coverage.universe.trees:
        assert f"<h2>{tree}</h2>" in drawn
    assert "times, first in" in drawn
    assert "http://" not in drawn.replace("http://www.w3.org/2000/svg", "")
