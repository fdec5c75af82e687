"""A port with a closed set of words takes no other, from a file or from a value of the tree."""

from __future__ import annotations

import pytest

from executive.core.types import Outcome, Reason
from executive.core.values import TEXT
from executive.run.schema import schema
from executive.tree.build import build
from executive.tree.catalogue import node_types
from executive.tree.load import load_tree_text
from executive.tree.nodes.base import In, Leaf


class Paint(Leaf):
    """Say a colour."""

    colour = In(TEXT, "which", choices=("red", "green"))

    def step(self) -> Outcome[object]:
        return Outcome(Reason.DONE, self.colour)


def painted(services, colour):
    text = "tree: t\nports: {x: {type: text}}\nroot: {paint: {colour: '{x}'}}\n"
    built = build(load_tree_text(text, "t.yaml", node_types((Paint,))), services, {"x": colour})
    built.root.tick_once()
    return built.root.feedback_message


@pytest.mark.parametrize(
    ("word", "rest"),
    [("tuning", 'did you mean "turning"?'), ("sideways", "expected turning or advance")],
)
def test_a_leaf_takes_its_choices_alone(bench, word, rest):
    (problem,) = bench.problems(f"tree: t\nroot: {{compensate: {{of: {word}}}}}\n")
    assert problem.startswith(f't.yaml:2:25: got "{word}", expected turning or advance')
    assert problem.endswith(rest)


def test_the_schema_lists_the_choices_of_a_leaf():
    own = schema("tree")["$defs"]["node"]["anyOf"][1]["properties"]
    assert own["compensate"]["properties"]["of"]["anyOf"][0] == {"enum": ["turning", "advance"]}


def test_the_schema_knows_how_many_children_a_loop_has():
    own = schema("tree")["$defs"]["node"]["anyOf"][1]["properties"]
    listing = own["loop"]["anyOf"][1]
    assert (listing["minItems"], listing["maxItems"]) == (2, 2)


def test_a_leaf_fails_where_a_value_of_the_tree_is_no_choice(bench):
    assert painted(bench.services, "red") == "red"
    assert painted(bench.services, "blue") == "port colour: got 'blue', expected one of red, green"
