import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from executive.core.errors import ConfigError
from executive.tree.load import load_tree, load_tree_text
from executive.tree.spec import walk


def in_tree(root, ports="{}"):
    return f"tree: t\nports: {ports}\nroot: {root}\n"


@pytest.mark.parametrize(
    ("root", "problem"),
    [
        ("{wiat: {duration: 3 s}}", 't.yaml:3:8: got the unknown node "wiat", expected a node or a tree; did you mean "wait"?'),  # noqa: E501  (as it is printed)
        ("{wait: {durtion: 3 s, duration: 1 s}}", 't.yaml:3:15: got the unknown port "durtion" of wait, expected duration; did you mean "duration"?'),  # noqa: E501  (as it is printed)
        ("{wait: {}}", 't.yaml:3:8: wait needs "duration": how long to wait (duration)'),
        ("{wait: {duration: 3}}", "t.yaml:3:25: got 3 without a unit, expected a duration such as '36 s'"),
        ("{wait: {duration: 3 m}}", "t.yaml:3:25: got '3 m' (a length), expected a duration such as '36 s'"),
        ("{act: {ticks: 1.5}}", "t.yaml:3:21: got 1.5, expected a whole number"),
        ("{measure: {value: 3 m}}", 't.yaml:3:25: got "3 m" for a port that is written, expected a reference such as {value}'),  # noqa: E501  (as it is printed)
        ("{visit: {target: 3 m}}", 't.yaml:3:24: got "3 m", expected a reference to a Point such as {x}'),
        ("{note: {value: '{depth}'}}", "t.yaml:3:22: got {depth}, which is neither a port of this tree nor written in it, expected one that is"),  # noqa: E501  (as it is printed)
        ("{sequence: []}", "t.yaml:3:18: got a list of 0 as children of sequence, expected a list of nodes"),
        ("{inverter: {}}", "t.yaml:3:8: inverter needs one child"),
        ("{retry: {attempts: 2}}", "t.yaml:3:8: retry needs one child"),
        ("{retry: {attempts: 0, child: act}}", "t.yaml:3:26: got 0, expected 1 or more"),
        ("{parallel: {policy: any, children: [act]}}", 't.yaml:3:27: got "any", expected all or one'),
        ("{act: {}, wait: {duration: 1 s}}", "t.yaml:3:7: got act or wait, expected exactly one node type beside name, skip_if, while, success_if or failure_if"),  # noqa: E501  (as it is printed)
        ("{act: {}, skipif: 'true'}", 't.yaml:3:7: got act or skipif, expected exactly one node type beside name, skip_if, while, success_if or failure_if; did you mean "skip_if"?'),  # noqa: E501  (as it is printed)
        ("3", "t.yaml:3:7: got 3, expected a node such as {wait: {duration: 5 s}}"),
    ],
)  # fmt: skip
def test_a_wrong_node_is_told_with_its_place_and_a_guess(bench, root, problem):
    assert bench.problems(in_tree(root)) == [problem]


@pytest.mark.parametrize(
    ("guard", "problem"),
    [
        ("{pose.cross_trak} < 1 m", "27: got the unknown attribute 'cross_trak' of a PoseEstimate"),
        ("{pse.x} < 1 m", 'did you mean "pose"?'),
        ("{pose.tilt} < 30 mm", "41: got a length, expected an angle to compare with '<'"),
        ("{pose.tilt} < 30 foo", "44: got 'foo', expected a unit"),
        ("{pose.tilt} <", "40: got 'the end', expected a number"),
        ("{pose.x} + 1 m", "got a length, expected something true or false"),
        ("__import__('os')", "got '__import__', expected a number"),
    ],
)
def test_a_wrong_guard_is_told_at_its_column(bench, guard, problem):
    text = in_tree(f'{{act: {{}}, skip_if: "{guard}"}}', "{pose: {type: PoseEstimate}}")
    (found,) = bench.problems(text)
    assert found.startswith("t.yaml:3:")
    assert problem in found


def test_a_value_has_one_type_in_its_tree(bench):
    root = "{sequence: [{measure: {value: '{x}'}}, {see: {pose: '{x}'}}, {act: {ticks: '{x}'}}]}"
    assert bench.problems(in_tree(root)) == [
        "t.yaml:3:59: got {x}, of type length, expected type PoseEstimate",
        "t.yaml:3:82: got {x}, of type length, expected type integer",
    ]


def test_an_in_port_of_the_tree_cannot_be_written(bench):
    (problem,) = bench.problems(in_tree("{measure: {value: '{depth}'}}", "{depth: {type: length}}"))
    assert problem == "t.yaml:3:25: got {depth} for a port that is written, but it is an in port of this tree"


def test_an_unknown_port_type_is_told_with_a_guess(bench):
    (problem,) = bench.problems(in_tree("act", "{s: {type: Segmnt}}"))
    assert 'did you mean "Segment"?' in problem


def test_many_problems_are_told_at_once(bench):
    problems = bench.problems(
        in_tree("{sequence: [wiat, {act: {ticks: x}}, {wait: {}}, {act: {}, while: '('}]}")
    )
    assert len(problems) == 4


@pytest.fixture
def trees(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "trees").mkdir()

    def write(name, text):
        (tmp_path / "trees" / f"{name}.yaml").write_text(text)

    return write


def test_a_tree_inside_itself_is_located(trees):
    trees("one", "tree: one\nroot: {sequence: [{two: {}}]}\n")
    trees("two", "tree: two\nroot:\n  inverter: {one: {}}\n")
    with pytest.raises(ConfigError) as caught:
        load_tree("one")
    assert str(caught.value) == (
        "trees/two.yaml:3:14: got a tree inside itself (one > two > one), expected no recursion"
    )


def test_problems_of_a_sub_tree_are_told_once_in_its_own_file(trees):
    trees("outer", "tree: outer\nroot: {sequence: [{inner: {}}, {inner: {}}, {wait: {duration: 3}}]}\n")
    trees("inner", "tree: inner\nroot: {wait: {duration: 5 m}}\n")
    with pytest.raises(ConfigError) as caught:
        load_tree("outer")
    assert [p.file for p in caught.value.problems] == ["trees/inner.yaml", "trees/outer.yaml"]


def test_ports_of_a_sub_tree_are_checked_like_those_of_a_leaf(trees):
    trees("outer", "tree: outer\nroot: {inner: {dept: 3 m}}\n")
    trees("inner", "tree: inner\nports: {depth: {type: length}}\nroot: {wait: {duration: 5 s}}\n")
    with pytest.raises(ConfigError) as caught:
        load_tree("outer")
    assert [p.message for p in caught.value.problems] == [
        'inner needs "depth": a value (length)',
        'got the unknown port "dept" of inner, expected depth; did you mean "depth"?',
    ]


def test_trees_that_unfold_without_end_are_refused(trees):
    for index in range(14):
        trees(
            f"t{index}",
            f"tree: t{index}\nroot: {{sequence: [{{t{index + 1}: {{}}}}, {{t{index + 1}: {{}}}}]}}\n",
        )
    trees("t14", "tree: t14\nroot: {wait: {duration: 1 s}}\n")
    with pytest.raises(ConfigError, match="nodes with its sub-trees, expected 5000 at most"):
        load_tree("t0")


def test_a_missing_tree_is_told_with_a_guess(trees):
    trees("navigate", "tree: navigate\nroot: {wait: {duration: 1 s}}\n")
    with pytest.raises(ConfigError, match='did you mean "navigate"'):
        load_tree("navigte")


def test_paths_are_readable_and_unique(bench):
    spec = bench.load(
        in_tree("{sequence: [act, act, {act: {}, name: third}, {inverter: {wait: {duration: 1 s}}}]}")
    )
    assert [path for path, _ in walk(spec)] == [
        "t/sequence",
        "t/sequence/act",
        "t/sequence/act#2",
        "t/sequence/third",
        "t/sequence/inverter",
        "t/sequence/inverter/wait",
    ]


nodes = st.recursive(
    st.sampled_from(["wait", "act", "x", 3, None, True, "{x}", "1 s", "all"]),
    lambda inner: st.one_of(
        st.lists(inner, max_size=3),
        st.dictionaries(
            st.sampled_from(
                ["sequence", "wait", "retry", "for_each", "timeout", "child", "children", "attempts", "in", "as",  # noqa: E501  (as it is printed)
                 "duration", "after", "skip_if", "while", "name", "recover", "memory"]
            ),
            inner,
            max_size=3,
        ),
    ),
    max_leaves=10,
)  # fmt: skip


@settings(max_examples=200, deadline=None)
@given(nodes)
def test_any_root_is_a_tree_or_a_config_error(root):
    import json

    try:
        spec = load_tree_text(json.dumps({"tree": "t", "root": root}), "t.yaml")
    except ConfigError as error:
        assert all(p.line >= 1 and p.column >= 1 for p in error.problems)
    else:
        assert list(walk(spec))


def test_a_former_name_of_a_leaf_still_works():
    tree = load_tree_text(in_tree("{doubt_prediction: {position: 20 cm}}"))
    assert (tree.root.name, tree.root.type) == ("inflate_prediction", "inflate_prediction")


def test_a_former_name_still_has_its_ports_checked():
    with pytest.raises(ConfigError, match=r'unknown port "positoin".*did you mean "position"'):
        load_tree_text(in_tree("{doubt_prediction: {positoin: 20 cm}}"))
