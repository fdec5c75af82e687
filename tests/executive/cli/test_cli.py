import json
import re

import pytest

from executive.cli import cli, invoke

GOOD = "tree: go\ndoc: Wait.\nroot: {wait: {duration: 5 s}}\n"
BAD = "tree: go\nroot:\n  sequence:\n    - wiat: {}\n    - wait: {duration: 5}\n"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "trees").mkdir()
    (tmp_path / "trees" / "go.yaml").write_text(GOOD)
    (tmp_path / "bad.yaml").write_text(BAD)
    return tmp_path


def test_check_is_silent_about_good_files(folder, capsys):
    assert invoke(["check", "trees/go.yaml"]) == 0
    assert capsys.readouterr().out == ""


def test_check_prints_every_problem_and_ends_with_1(folder, capsys):
    assert invoke(["check", "bad.yaml", "trees/go.yaml"]) == 1
    assert capsys.readouterr().out.splitlines() == [
        'bad.yaml:4:7: got the unknown node "wiat", expected a node or a tree; did you mean "wait"?',
        "bad.yaml:5:24: got 5 without a unit, expected a duration such as '36 s'",
    ]


def test_check_writes_json_and_sarif(folder, capsys):
    assert invoke(["check", "bad.yaml", "--format", "json"]) == 1
    assert json.loads(capsys.readouterr().out)["problems"][1]["column"] == 24
    assert invoke(["check", "bad.yaml", "--format", "sarif"]) == 1
    (run,) = json.loads(capsys.readouterr().out)["runs"]
    place = run["results"][0]["locations"][0]["physicalLocation"]
    assert place == {"artifactLocation": {"uri": "bad.yaml"}, "region": {"startLine": 4, "startColumn": 7}}


def test_check_of_an_absent_file_is_a_usage_error(folder, capsys):
    assert invoke(["check", "none.yaml"]) == 2
    assert capsys.readouterr().err == "none.yaml:1:1: no such file\n"


def test_a_file_of_no_known_kind_is_told(folder, capsys):
    (folder / "odd.yaml").write_text("scenaro: x\n")
    assert invoke(["check", "odd.yaml"]) == 1
    assert 'did you mean "scenario"?' in capsys.readouterr().out


def test_show_draws_by_name_and_into_a_file(folder, capsysbinary):
    assert invoke(["show", "go"]) == 0
    assert "└─ wait  duration: 5 s" in capsysbinary.readouterr().out.decode()
    assert invoke(["show", "trees/go.yaml", "--format", "svg", "-o", "go.svg"]) == 0
    assert (folder / "go.svg").read_text().startswith("<svg")


def test_bad_input_to_show_ends_with_2_and_writes_nothing(folder, capsys):
    assert invoke(["show", "bad.yaml", "-o", "out.svg", "--format", "svg"]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 2
    assert not (folder / "out.svg").exists()
    assert invoke(["show", "go", "--format", "sgv"]) == 2
    assert 'did you mean "svg"?' in capsys.readouterr().err


def test_the_nodes_are_listed_from_their_declarations(capsys):
    assert invoke(["nodes"]) == 0
    assert "Let mission time pass." in capsys.readouterr().out
    assert invoke(["nodes", "wait", "--json"]) == 0
    (port,) = json.loads(capsys.readouterr().out)["wait"]["ports"]
    assert (port["name"], port["type"], port["required"]) == ("duration", "duration", True)
    assert invoke(["nodes", "wiat"]) == 2
    assert 'did you mean "wait"?' in capsys.readouterr().err


@pytest.mark.parametrize("kind", ["tree", "mission", "scenario"])
def test_schemas_are_json_schema(kind, capsys):
    assert invoke(["schema", kind]) == 0
    made = json.loads(capsys.readouterr().out)
    assert made["$schema"].startswith("https://json-schema.org/")
    assert kind in made["required"]


def test_every_command_helps_with_an_example(capsys):
    for name in cli.commands:
        assert invoke([name, "--help"]) == 0
        assert f"Example: longarm {name}" in " ".join(capsys.readouterr().out.split())


def test_a_defect_ends_with_3_and_one_line(folder, capsys, monkeypatch):
    def broken(*_):
        raise RuntimeError("two\nlines")

    monkeypatch.setattr("executive.tree.load.load_tree", broken)
    assert invoke(["show", "go"]) == 3
    error = capsys.readouterr().err
    assert error.startswith("longarm: a defect: RuntimeError: two lines (test_cli.py:")
    assert error.count("\n") == 1


def test_unknown_options_are_usage_errors(capsys):
    assert invoke(["check", "--fromat", "json"]) == 2
    assert invoke(["nonsense"]) == 2
    capsys.readouterr()


def test_the_version_is_that_of_the_package(capsys):
    assert invoke(["--version"]) == 0
    assert re.fullmatch(r"longarm, version \d+\.\d+\.\d+\n", capsys.readouterr().out)
