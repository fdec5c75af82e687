"""docs/reference is what the declarations say, and every example on it does what it is shown for."""

from pathlib import Path

import pytest
import yaml

from executive.cli.reference import pages
from executive.cli.reference.prose import examples
from executive.core.values import ANGLE, FLAG, LENGTH, NUMBER
from executive.run.check import check_file
from executive.testing import Bench
from executive.tree.catalogue import node_types
from executive.tree.expressions.guards import parse_guard
from executive.tree.load import load_tree_text

FOLDER = Path(__file__).parents[1] / "docs" / "reference"
GIVEN = """tree: example
ports:
  route: {type: Route, direction: in}
  segment: {type: Segment, direction: in}
  pose: {type: PoseEstimate, direction: inout}
root:
"""
FACE_THE_END = """sequence:
  - turn_towards: {target: "{segment.end}", pose: "{pose}"}
  - localise: {pose: "{pose}"}
"""


def test_the_reference_is_up_to_date():
    """After changing a declaration: longarm reference."""
    made = pages()
    assert {path.name for path in FOLDER.glob("*.md")} == set(made)
    for name, text in made.items():
        assert (FOLDER / name).read_text() == text, f"{name} is out of date: run `longarm reference`"


def test_every_node_has_an_example():
    assert set(examples("nodes")) == set(node_types())


@pytest.mark.parametrize("node", sorted(examples("nodes")))
def test_the_example_of_a_node_uses_it_and_ends_as_it_says(node):
    text = examples("nodes")[node]
    assert f"{node}:" in text
    bench = Bench()
    assert _ended(bench, FACE_THE_END).outcome.ok
    ended = _ended(bench, text)
    assert ended.outcome.ok == ("# ends in failure" not in text), ended.outcome


def _ended(bench, root):
    """What a root node comes to, given a route, its first segment, and the pose there."""
    tree = GIVEN + "".join(f"  {line}\n" for line in root.splitlines())
    pose = bench.services.classification.predicted().on(bench.route[0])
    return bench.run_tree(tree, route=bench.route, segment=bench.route[0], pose=pose)


@pytest.mark.parametrize("case", examples("expressions"), ids=lambda case: case["write"])
def test_an_expression_comes_to_what_is_shown(case):
    values = case.get("with", {})
    guard = parse_guard(case["write"])
    types = {"depth": LENGTH, "tilt": ANGLE, "count": NUMBER, "stuck": FLAG}
    guard.check({name: types[name] for name in values})
    shown = {True: "true", False: "false", None: "undecided"}
    assert shown[guard.holds(lambda name, attributes: values[name])] == case["is"]


@pytest.mark.parametrize("kind", sorted(examples("files")))
def test_the_example_of_a_file_is_free_of_problems(kind, tmp_path):
    name = "longarm.yaml" if kind == "project" else f"{kind}.yaml"
    (tmp_path / name).write_text(examples("files")[kind]["example"])
    assert [str(problem) for problem in check_file(tmp_path / name)] == []


def test_the_example_of_a_tree_is_free_of_problems():
    block = (FOLDER / "tree.md").read_text().split("```yaml\n")[1].split("```")[0]
    assert load_tree_text(block, "approach.yaml").name == yaml.safe_load(block)["tree"]
