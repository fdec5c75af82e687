"""One of every kind from outside, known to every command: by entry points, module and project file."""

import json

import pytest

from executive.cli import invoke
from executive.config.file_kinds import kind_of
from executive.core import registry
from executive.record import History
from executive.record.events import NodeChange
from tests.system.plugins.conftest import ADDED


def said(capsys, *arguments):
    """What a command that succeeds prints."""
    assert invoke(list(arguments)) == 0
    return capsys.readouterr().out


@pytest.fixture
def outside(bring_in, way):
    """The working folder of a user who has the stranger's plug-in."""
    return bring_in(way)


def test_every_kind_that_exists_is_added():
    assert set(registry.kind_names()) == set(ADDED)


@pytest.mark.parametrize("kind", ADDED)
def test_the_catalogue_lists_what_was_added(outside, way, kind, capsys):
    listed = json.loads(said(capsys, kind.replace("_", "-"), "--json"))
    assert ADDED[kind][0] in listed


def test_the_sources_are_listed_with_what_they_add(outside, way, capsys):
    listed = json.loads(said(capsys, "plugins", "--json"))
    source = "longarm.yaml: stranger.py" if way == "project" else "stranger"
    if way == "module":
        source = "entry point longarm.plugins: stranger = stranger"
    assert listed[source]["leaves"] == ["weigh_sample"]
    assert listed[source]["value_types"] == ["mass"]
    assert "weigh_sample" not in listed["longarm"]["leaves"]


def test_a_leaf_is_among_the_nodes_with_its_ports(outside, capsys):
    node = json.loads(said(capsys, "nodes", "weigh_sample", "--json"))["weigh_sample"]
    assert [port["type"] for port in node["ports"]] == ["length", "mass"]


def test_files_that_use_it_are_checked(outside, capsys):
    said(capsys, "check", "outside.yaml", "weigh.yaml")
    tree = outside / "weigh.yaml"
    tree.write_text(tree.read_text().replace("40 mm", "40 kg"))
    assert invoke(["check", "weigh.yaml"]) == 1
    assert "weigh.yaml:6:29:" in capsys.readouterr().out


ASKING = """\
tree: weigh
ports: {route: {type: Route}}
root:
  sequence:
    - weigh_sample: {scoop: 40 mm, sample: "{sample}"}
    - wait: {duration: "{sample.patience}"}
      skip_if: "{sample.grams} > GRAMS"
"""


@pytest.mark.parametrize(("grams", "waits"), [("90", True), ("70", False)])
def test_attributes_of_its_values_are_read_in_ports_and_guards(outside, grams, waits):
    (outside / "weigh.yaml").write_text(ASKING.replace("GRAMS", grams))
    assert invoke(["run", "outside.yaml", "--set", "faults=[]", "--out", "out", "--quiet"]) == 0
    changes = History.of(outside / "out" / "record.mcap").all(NodeChange)
    of_wait = {at.event.status: at.time_s for at in changes if at.event.path.endswith("wait")}
    assert ("running" in of_wait) == waits
    assert not waits or of_wait["success"] - of_wait["running"] == 8.0


@pytest.mark.parametrize("where", ['duration: "{sample.patience}"', "{sample.grams}"])
def test_an_unknown_attribute_of_its_value_is_told_with_the_known(outside, where, capsys):
    wrong = where.replace("sample.", "sample.un")
    (outside / "weigh.yaml").write_text(ASKING.replace("GRAMS", "90").replace(where, wrong))
    assert invoke(["check", "weigh.yaml"]) == 1
    assert "of a mass, expected grams or patience" in capsys.readouterr().out


def test_its_signal_triggers_and_is_expected(outside, capsys):
    scenario = outside / "outside.yaml"
    text = scenario.read_text().replace("from: {time: 2 s}", "from: {when: heat > 30}")
    scenario.write_text(text.replace("expect: {", "expect: {eventually: heat > 40, "))
    said(capsys, "check", "outside.yaml")
    scenario.write_text(text.replace("heat > 30", "heet > 30"))
    assert invoke(["check", "outside.yaml"]) == 1
    assert 'did you mean "heat"?' in capsys.readouterr().out


def test_the_executives_own_files_are_kinds_among_the_strangers(outside, capsys):
    listed = json.loads(said(capsys, "files", "--json"))
    assert {"tree", "mission", "scenario", "project", "campaign", "coverage", "recipe"} == set(listed)
    for kind in listed:
        assert "$schema" in json.loads(said(capsys, "schema", kind))


@pytest.mark.parametrize(
    ("keys", "kind"),
    [
        (("mission", "tree", "waypoints"), "mission"),
        (("scenario", "project", "mission"), "scenario"),
        (("campaign", "scenario"), "campaign"),
        (("tree", "root", "mission"), "tree"),
        (("plugins",), None),
    ],
)
def test_a_file_with_the_keys_of_several_kinds_is_the_one_that_holds(keys, kind):
    assert kind_of(dict.fromkeys(keys, "x")) == kind


def test_it_is_drawn_and_in_the_schemas(outside, capsys):
    assert "weigh_sample" in said(capsys, "show", "weigh.yaml")
    assert "weigh_sample" in said(capsys, "schema", "tree")
    assert '"hum"' in said(capsys, "schema", "scenario")
    assert "recipe" in said(capsys, "schema", "recipe")


def test_a_mission_runs_on_it_and_is_told_of(outside, capsys):
    assert invoke(["run", "outside.yaml", "--out", "out", "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert [fault["fired"] for fault in result["faults"]] == [True]
    assert "weigh" in said(capsys, "explain", "out")
    assert "weigh_sample" in said(capsys, "show", "out")


def test_its_files_reports_and_commands_work(outside, capsys):
    (outside / "soup.yaml").write_text("recipe: 3\n")
    assert invoke(["check", "soup.yaml"]) == 1
    assert "soup.yaml:1:9: got no name" in capsys.readouterr().out
    (outside / "folder").mkdir()
    (outside / "folder" / "recipe.json").write_text('"soup"')
    assert said(capsys, "report", "folder") == "folder/report.html\n"
    assert said(capsys, "greet") == "hello from outside\n"


def test_a_run_is_replayed_from_another_folder(outside, way, monkeypatch, tmp_path, capfd):
    assert invoke(["run", "outside.yaml", "--out", "out", "--quiet"]) == 0
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    (outside / "out").rename(elsewhere / "out")
    monkeypatch.chdir(elsewhere)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path / "site"))
    assert invoke(["replay", "out"]) == 0, capfd.readouterr()
    assert "identical" in capfd.readouterr().out
