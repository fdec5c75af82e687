import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from executive.cli import invoke

SCENARIO = "scenarios/hidden_markers.yaml"


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    """A project as written, which no test changes."""
    folder = tmp_path_factory.mktemp("init") / "mine"
    assert invoke(["init", str(folder)]) == 0
    return folder


def longarm(folder, *arguments):
    """The command as a user calls it, in a process of its own, with this working folder."""
    program = Path(sys.executable).with_name("longarm")
    done = subprocess.run([program, *arguments], cwd=folder, capture_output=True, text=True)
    return done.returncode, done.stdout + done.stderr


def test_every_file_it_writes_is_free_of_problems(project, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    written = [str(path) for path in project.rglob("*.yaml")]
    assert len(written) == 5
    assert invoke(["check", *written]) == 0


def test_it_runs_from_another_folder_and_after_a_move(project, tmp_path):
    yours = tmp_path / "elsewhere" / "yours"
    shutil.copytree(project, yours)
    code, said = longarm(tmp_path, "run", f"elsewhere/yours/{SCENARIO}", "--quiet", "--out", "first")
    assert (code, said) == (0, "")
    tried = [row["name"] for row in json.loads((tmp_path / "first/result.json").read_text())["strategies"]]
    assert tried == ["cabin_reposing", "look_again"]
    code, drawn = longarm(tmp_path, "show", "first")
    assert code == 0, drawn
    assert "✓ ◇ stands_level" in drawn
    code, said = longarm(yours, "coverage", str(tmp_path / "first"))
    assert code == 0, said


def test_its_scenario_and_its_tests_pass(project, tmp_path):
    mine = tmp_path / "mine"
    shutil.copytree(project, mine)
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "tests"], cwd=mine, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout
    assert "6 passed" in done.stdout
    found = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "--co"], cwd=mine, capture_output=True, text=True
    )
    assert "hidden_markers" in found.stdout
    code, said = longarm(tmp_path, "test", "mine/scenarios")
    assert code == 0, said


def test_an_editor_gets_a_schema_for_every_file_of_the_project(project):
    settings = json.loads((project / ".vscode/settings.json").read_text())["yaml.schemas"]
    matched = {path for patterns in settings.values() for p in patterns for path in project.glob(p)}
    assert matched == set(project.rglob("*.yaml"))
    for schema in settings:
        assert json.loads((project / schema).read_text())["$schema"]
    node = json.loads((project / ".vscode/schemas/tree.json").read_text())["$defs"]["node"]["anyOf"][1]
    assert "stands_level" in node["properties"]


def test_schemas_are_written_anew_for_a_leaf_that_was_added(project, tmp_path):
    mine = tmp_path / "mine"
    shutil.copytree(project, mine)
    plugin = mine / "plugin.py"
    plugin.write_text(plugin.read_text().replace("StandsLevel", "SitsUpright"))
    assert invoke(["init", str(mine), "--schemas"]) == 0
    assert "sits_upright" in (mine / ".vscode/schemas/tree.json").read_text()


@pytest.mark.parametrize("there", ["notes.txt", "longarm.yaml", ".git/config"])
def test_a_folder_with_files_in_it_is_refused_and_left_alone(there, tmp_path, capsys):
    file = tmp_path / there
    file.parent.mkdir(exist_ok=True)
    file.write_text("")
    assert invoke(["init", str(tmp_path)]) == 2
    assert "--force" in capsys.readouterr().err
    assert [path for path in tmp_path.rglob("*") if path.is_file()] == [file]
    assert file.read_text() == ""


def test_force_keeps_what_is_not_of_the_project(tmp_path):
    (tmp_path / "notes.txt").write_text("mine")
    (tmp_path / "longarm.yaml").write_text("plugins: [gone.py]")
    assert invoke(["init", str(tmp_path), "--force"]) == 0
    assert (tmp_path / "notes.txt").read_text() == "mine"
    assert "plugin.py" in (tmp_path / "longarm.yaml").read_text()


@pytest.mark.parametrize("arguments", [[], ["--force"], ["--schemas"]])
def test_a_file_is_refused_in_one_line(arguments, tmp_path, capsys):
    (tmp_path / "taken").write_text("")
    assert invoke(["init", str(tmp_path / "taken"), *arguments]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1
