"""A control node of one's own is one class in one file: every tool knows it, and nothing else is changed."""

from __future__ import annotations

import json
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
import yaml

from executive.cli import invoke
from executive.config.project import read_project
from executive.config.source import read
from executive.core.registry import in_project
from executive.record import History
from executive.record.events import NodeChange
from executive.tree.catalogue import node_types
from executive.tree.load import load_tree
from proving.coverage.universe import Universe
from proving.mutation.operators import OPERATORS, MutationSite
from proving.mutation.sites import sites

MAJORITY = '''
from longarm import FAILS, SUCCEEDS, TEXT, Attribute, ControlNode, Groot, In
from py_trees.common import Status
from py_trees.composites import Composite


class Majority(ControlNode):
    """Run every child to its end, in turn; end as most of them did."""

    symbol = "½"
    counterpart = "sequence"
    groot = Groot("Vote", {"tie": Attribute("on_tie", str.upper, lambda text, children: text.lower())})

    tie = In(TEXT, "what a tie comes to", "failure", choices=("failure", "success"), fixed=True)

    def make(self, children, context):
        return Votes(context.name, children, self.tie)

    def abilities(self, inside):
        able = frozenset().union(*inside)
        return able | {self.tie} if {SUCCEEDS, FAILS} <= able else able


class Votes(Composite):
    def __init__(self, name, children, tie):
        super().__init__(name, children)
        self.tie = tie

    def tick(self):
        if self.status is not Status.RUNNING:
            self.left, self.votes = list(self.children), []
        while self.left:
            yield from self.left[0].tick()
            if self.left[0].status is Status.RUNNING:
                self.status = Status.RUNNING
                yield self
                return
            self.votes.append(self.left.pop(0).status)
        yes = 2 * self.votes.count(Status.SUCCESS)
        won = yes > len(self.votes) or (yes == len(self.votes) and self.tie == "success")
        self.stop(Status.SUCCESS if won else Status.FAILURE)
        yield self
'''
TREE = """\
tree: vote
ports: {route: {type: Route}}
root:
  majority:
    tie: success
    children:
      - always: {success: false}
      - wait: {duration: 3 s}
        name: pause
"""
SCENARIO = """\
scenario: voted
backend: fake
localizer: overhead
tier: geometric
seed: 1
time_limit: 10 min
mission: {mission: voted, tree: vote, waypoints: [{x: 2.2 m, y: -0.5 m}, {x: 2.4 m, y: -0.5 m}]}
expect: {outcome: safe_hold}
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A project with the node, a tree that uses it, and a scenario."""
    monkeypatch.chdir(tmp_path)
    files = {"majority.py": MAJORITY, "longarm.yaml": "plugins: [majority.py]\n"}
    for name, text in (files | {"vote.yaml": TREE, "voted.yaml": SCENARIO}).items():
        Path(name).write_text(text)
    return tmp_path


@pytest.fixture
def said(folder: Path, capsys: pytest.CaptureFixture[str]):
    def said(*words: str, code: int = 0) -> str:
        assert invoke(list(words)) == code
        captured = capsys.readouterr()
        return captured.out + captured.err

    return said


@pytest.fixture
def project(folder: Path):
    with in_project(read_project(folder / "longarm.yaml")):
        yield


def test_the_check_knows_its_ports_choices_and_children(said):
    said("check", "vote.yaml")
    Path("vote.yaml").write_text(TREE.replace("tie: success", "tie: succes"))
    assert 'vote.yaml:5:10: got "succes", expected failure or success; did you mean "success"?' in said(
        "check", "vote.yaml", code=1
    )
    Path("vote.yaml").write_text("tree: vote\nroot:\n  majority: {children: []}\n")
    assert "got a list of 0 as children of majority" in said("check", "vote.yaml", code=1)


def test_the_catalogue_and_the_schema_show_it(said):
    entry = json.loads(said("nodes", "majority", "--json"))["majority"]
    assert (entry["category"], entry["children"]) == ("control", "many")
    assert entry["ports"][0]["choices"] == ["failure", "success"]
    own = json.loads(said("schema", "tree"))["$defs"]["node"]["anyOf"][1]["properties"]["majority"]
    assert own["anyOf"][0]["properties"]["tie"]["enum"] == ["failure", "success"]
    assert own["anyOf"][1] == {"type": "array", "items": {"$ref": "#/$defs/node"}, "minItems": 1}


def test_drawings_bear_its_symbol_and_ports(said):
    assert "└─ ½ majority  tie: success\n" in said("show", "vote.yaml")
    assert "½" in said("show", "vote.yaml", "--format", "svg")


def test_it_is_exported_and_imported_under_its_foreign_name(said):
    xml = said("show", "vote.yaml", "--format", "groot")
    vote = ET.fromstring(xml).find("BehaviorTree/Vote")
    assert vote is not None
    assert vote.attrib == {"on_tie": "SUCCESS"}
    Path("vote.xml").write_text(xml)
    said("import", "vote.xml", "-o", "again")
    assert yaml.safe_load(Path("again/vote.yaml").read_text())["root"] == yaml.safe_load(TREE)["root"]


def test_a_run_ticks_it_and_records_it(said, folder):
    said("run", "voted.yaml", "--out", "out", "--quiet", "--json")
    changes = [c.event for c in History.of(folder / "out" / "record.mcap").all(NodeChange)]
    assert [c.status for c in changes if c.path == "vote/majority"] == ["running", "success"]
    assert [c.status for c in changes if c.path == "vote/majority/pause"] == ["running", "success"]


def test_coverage_goes_by_its_abilities(project):
    universe = Universe()
    universe.add(load_tree("vote"), {})
    assert universe.words["vote/majority"] == ["success", "failure", "running"]
    assert universe.words["vote/majority/pause"] == ["success", "device", "running"]


def test_mutation_changes_it_like_any_other(project):
    source, types = read(Path("vote.yaml"), "vote.yaml"), node_types()
    scene = MutationSite(source, types, lambda word: {port.name: port for port in types[word].ports})
    (site,) = (site for site in sites(source, types) if site.word == "majority")
    made = [change.what for operator in OPERATORS.values() for change in operator(scene, site)]
    assert made == [
        "swap always and pause (1, 2)",
        "drop always (1)",
        "drop pause (2)",
        "sequence for majority",
        "tie failure for success",
    ]


def test_one_that_cannot_be_used_is_named_where_a_tree_uses_it(said):
    Path("majority.py").write_text(MAJORITY.replace('"what a tie comes to"', '""'))
    told = said("check", "vote.yaml", code=1)
    assert "control node majority: its port tie does not say what it is for" in told
    assert "longarm.yaml: majority.py" in told
