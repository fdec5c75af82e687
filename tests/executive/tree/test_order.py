"""What is read before it is written: `check` against what the engine meets, over generated trees."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from py_trees.common import Status

from executive.core.clock import Clock
from executive.core.errors import ConfigError
from executive.core.types import Outcome, Reason
from executive.core.values import INTEGER
from executive.tree.build import build
from executive.tree.catalogue import node_types
from executive.tree.load import load_tree_text
from executive.tree.nodes.base import In, Leaf, Out

MOST_RUNS, MOST_CHOICES, MOST_TICKS = 700, 7, 9


class EnoughError(Exception):
    """The script of this run is over."""


class _Scripted(Leaf):
    """Goes on, fails or succeeds as the script has it."""

    outcomes = (Reason.DONE, Reason.BLOCKED)

    def step(self) -> Outcome[object] | None:
        match self.services.script.next():
            case 0:
                return self.done()
            case 1:
                return Outcome(Reason.BLOCKED)
        return None

    def done(self) -> Outcome[object]:
        return Outcome(Reason.DONE)


class Reads(_Scripted):
    """Read a value when entered."""

    value = In[int](INTEGER, "what is read")

    def begin(self) -> None:
        self.read = self.value


class Writes(_Scripted):
    """Write a value on success."""

    value = Out[int](INTEGER, "what is written")

    def done(self) -> Outcome[object]:
        self.value = 1
        return super().done()


TYPES = node_types((Reads, Writes))


class Script:
    """Choices from a list; those beyond it are noted as not yet made."""

    def __init__(self, choices: list[int]) -> None:
        self.choices, self.taken = choices, 0

    def next(self) -> int:
        if self.taken == len(self.choices):
            raise EnoughError
        self.taken += 1
        return self.choices[self.taken - 1]


def text(root: str) -> str:
    return f"tree: t\nroot: {root}\n"


def complains(root: str) -> bool:
    try:
        load_tree_text(text(root), "t.yaml", TYPES)
    except ConfigError as error:
        assert all("may not be set yet here" in problem.message for problem in error.problems)
        return True
    return False


def runs(root: str) -> Iterator[bool | None]:
    """Whether each run of the engine reads too early; None where not all could be tried."""
    from executive.tree import load, order_of_nodes

    real = load.order_of
    load.order_of = lambda node, ports: (order_of_nodes.order_of(node, ports)[0], ())
    try:
        spec = load_tree_text(text(root), "t.yaml", TYPES)
    finally:
        load.order_of = real
    open_ones: list[list[int]] = [[]]
    for _ in range(MOST_RUNS):
        if not open_ones:
            return
        choices = open_ones.pop()
        services = SimpleNamespace(script=Script(choices), clock=Clock(1.0))
        built = build(spec, services)  # type: ignore[arg-type]  # all that these leaves need
        try:
            for _ in range(MOST_TICKS):
                built.root.tick_once()
                if any(outcome.reason is Reason.UNSET for outcome in built.trace.take_ended().values()):
                    yield True
                    break
                if built.root.status is not Status.RUNNING:
                    yield False
                    break
        except Exception as error:  # of the leaf, named by its path
            if not isinstance(error.__cause__, EnoughError):
                raise
            if len(choices) < MOST_CHOICES:
                open_ones += [[*choices, choice] for choice in (2, 1, 0)]
    yield None


NAMES = st.sampled_from(["x", "y"])
LEAF_NODES = st.builds("{{reads: {{value: '{{{}}}'}}}}".format, NAMES) | st.builds(
    "{{writes: {{value: '{{{}}}'}}}}".format, NAMES
)


def _within(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    some = st.lists(inner, min_size=1, max_size=3).map(", ".join)
    return (
        st.builds("{{{}: [{}]}}".format, st.sampled_from(["sequence", "selector"]), some)
        | st.builds(
            "{{parallel: {{policy: {}, children: [{}]}}}}".format, st.sampled_from(["all", "one"]), some
        )
        | st.builds("{{loop: [{}, {}]}}".format, inner, inner)
        | st.builds("{{retry: {{attempts: 2, child: {}}}}}".format, inner)
        | st.builds("{{timeout: {{after: 2 s, child: {}}}}}".format, inner)
        | st.builds(
            "{{{}: {}}}".format, st.sampled_from(["inverter", "force_success", "force_failure"]), inner
        )
    )


TREES = st.recursive(LEAF_NODES, _within, max_leaves=4)


@settings(max_examples=150, deadline=None)
@given(st.builds("{{sequence: [{}, {}]}}".format, TREES, TREES))
def test_check_complains_exactly_where_some_run_reads_too_early(tree):
    # both values are written somewhere, so that the check of names has nothing to say
    root = f"{{selector: [{tree}, {{writes: {{value: '{{x}}'}}}}, {{writes: {{value: '{{y}}'}}}}]}}"
    met = list(runs(root))
    if complains(root):
        assert True in met or None in met
    else:
        assert True not in met


@pytest.mark.parametrize(
    "root",
    [
        "{sequence: [{reads: {value: >'{x}'}}, {writes: {value: '{x}'}}]}",
        "{sequence: [{writes: {value: '{x}'}, skip_if: '1 < 2'}, {reads: {value: >'{x}'}}]}",
        "{sequence: [{writes: {value: '{x}'}, while: '>{x} > 2'}]}",
        "{selector: [{writes: {value: '{x}'}}, {reads: {value: >'{x}'}}]}",
    ],
)
def test_a_value_read_too_early_is_told_where_it_stands(root):
    """The place is marked by the first `>`."""
    column = len("root: ") + root.index(">") + 1
    with pytest.raises(ConfigError) as caught:
        load_tree_text(text(root.replace(">", "", 1)), "t.yaml", TYPES)
    (problem,) = caught.value.problems
    assert str(problem).startswith(f"t.yaml:2:{column}: got {{x}}, which may not be set yet here")


@pytest.fixture
def trees(tmp_path, monkeypatch):
    """A tree that reads {given} at once, and one that writes {made} for sure."""
    monkeypatch.chdir(tmp_path)
    ports = "ports: {given: {type: integer, direction: inout}}"
    (tmp_path / "asks.yaml").write_text(f"tree: asks\n{ports}\nroot: {{reads: {{value: '{{given}}'}}}}\n")
    ports = "ports: {made: {type: integer, direction: out}}"
    (tmp_path / "makes.yaml").write_text(f"tree: makes\n{ports}\nroot: {{writes: {{value: '{{made}}'}}}}\n")


@pytest.mark.parametrize(
    ("root", "problems"),
    [
        ("{sequence: [{makes.yaml: {made: '{x}'}}, {asks.yaml: {given: '{x}'}}]}", 0),
        ("{sequence: [{asks.yaml: {given: '{x}'}}, {makes.yaml: {made: '{x}'}}]}", 1),
        ("{sequence: [{asks.yaml: {}}]}", 1),
        ("{selector: [{makes.yaml: {made: '{x}'}}, {asks.yaml: {given: '{x}'}}]}", 1),
    ],
)
def test_sub_trees_need_and_set_what_their_nodes_do(trees, root, problems):
    try:
        load_tree_text(text(root), "t.yaml", TYPES)
    except ConfigError as error:
        assert len(error.problems) == problems
    else:
        assert problems == 0
