"""The project file: where bare names lead, what a scenario has by default, and what is wrong in it."""

import json
import shutil
from pathlib import Path

import pytest

from executive.cli import invoke
from executive.config.project import project_above
from executive.core import registry
from executive.core.errors import ConfigError
from executive.record import digest
from executive.run.resolve import resolve_scenario

REST = "tree: {name}\nports: {{route: {{type: Route}}}}\nroot: {root}\n"
MISSION = "mission: short\ntree: rest\nwaypoints: [{x: 2.2 m, y: -0.5 m}, {x: 2.4 m, y: -0.5 m}]\n"
DEFAULTS = "defaults: {tier: geometric, backend: fake, localizer: overhead, seed: 5}\n"
LEAF = """\
from longarm import Leaf, Outcome, Reason

from . import {sibling}


class {name}(Leaf):
    "Says hello."

    def step(self):
        return Outcome(Reason.DONE, {sibling}.WORD)
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A project with a mission beside its tree; the working folder is another."""
    project = tmp_path / "project"
    (project / "deep").mkdir(parents=True)
    (project / "longarm.yaml").write_text(DEFAULTS)
    (project / "deep" / "short.yaml").write_text(MISSION)
    (project / "deep" / "rest.yaml").write_text(REST.format(name="rest", root="{wait: {duration: 5 s}}"))
    monkeypatch.chdir(tmp_path)
    return project


def problems(folder, text):
    (folder / "longarm.yaml").write_text(text)
    with pytest.raises(ConfigError) as caught:
        project_above(folder / "deep")
    return str(caught.value).splitlines()


def test_defaults_stand_where_a_scenario_does_not_say(folder):
    scenario = resolve_scenario(folder / "deep" / "short.yaml")
    assert (scenario.backend.name, scenario.tier, scenario.seed) == ("fake", "geometric", 5)
    assert resolve_scenario(folder / "deep" / "short.yaml", seed=7).seed == 7


def test_a_wrong_default_is_told_at_its_place_in_the_project_file(folder):
    (folder / "longarm.yaml").write_text("defaults:\n  backend: fakee\n  tier: geometric\n")
    with pytest.raises(ConfigError, match=r'project/longarm.yaml:2:12: got the unknown backend "fakee"'):
        resolve_scenario(folder / "deep" / "short.yaml")


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("plugin: [a.py]", '1:1: got the unknown key "plugin", expected paths, plugins or defaults;'),
        ("plugins: [a.py]", '1:11: got "a.py", expected a Python file beside this file'),
        ("paths: [lib]", '1:9: got "lib", expected a folder beside this file'),
        ("defaults: {tire: full}", '1:12: got the unknown key "tire", expected tier, backend, localizer or'),
        ("plugins: a.py", '1:10: got "a.py", expected a list'),
        ("- paths", "1:1: got a list of 1, expected a mapping with paths, plugins or defaults"),
    ],
)
def test_what_is_wrong_in_a_project_file_is_told_at_its_place(folder, text, problem):
    (found,) = problems(folder, text + "\n")
    assert found.startswith(f"project/longarm.yaml:{problem}")


def test_a_bad_project_file_is_bad_input(folder, monkeypatch, capsys):
    (folder / "longarm.yaml").write_text("plugin: []\n")
    monkeypatch.chdir(folder / "deep")
    assert invoke(["check", "rest.yaml"]) == 2
    assert 'did you mean "plugins"?' in capsys.readouterr().err


def test_an_empty_project_file_is_a_project(folder):
    (folder / "longarm.yaml").write_text("")
    assert project_above(folder / "deep").file == folder / "longarm.yaml"


def test_the_file_that_is_processed_decides_not_the_working_folder(folder, tmp_path):
    (tmp_path / "longarm.yaml").write_text("defaults: {seed: 9}\n")
    assert resolve_scenario(folder / "deep" / "short.yaml").seed == 5


def test_the_working_folder_decides_for_files_outside_any_project(folder, tmp_path, monkeypatch):
    shutil.move(folder / "deep", tmp_path / "loose")
    monkeypatch.chdir(folder)
    assert resolve_scenario(tmp_path / "loose" / "short.yaml").seed == 5


def test_a_name_beside_the_referring_file_comes_before_the_paths(folder):
    (folder / "lib").mkdir()
    (folder / "lib" / "rest.yaml").write_text(REST.format(name="rest", root="{wait: {duration: 9 s}}"))
    (folder / "longarm.yaml").write_text(DEFAULTS + "paths: [lib]\n")
    assert resolve_scenario(folder / "deep" / "short.yaml").tree.root.ports["duration"].value == 5.0
    (folder / "deep" / "rest.yaml").unlink()
    assert resolve_scenario(folder / "deep" / "short.yaml").tree.root.ports["duration"].value == 9.0


def test_a_name_in_the_paths_comes_before_the_working_folder(folder, tmp_path):
    (folder / "deep" / "rest.yaml").unlink()
    for root, seconds in ((folder / "lib", 9), (tmp_path, 7)):
        (root / "trees").mkdir(parents=True)
        tree = REST.format(name="rest", root=f"{{wait: {{duration: {seconds} s}}}}")
        (root / "trees" / "rest.yaml").write_text(tree)
    (folder / "longarm.yaml").write_text(DEFAULTS + "paths: [lib]\n")
    assert resolve_scenario(folder / "deep" / "short.yaml").tree.root.ports["duration"].value == 9.0


def test_a_file_beside_of_another_kind_is_passed_over(folder):
    """A scenario may be called as its mission is, which lies elsewhere."""
    (folder / "missions").mkdir()
    shutil.move(folder / "deep" / "short.yaml", folder / "missions" / "short.yaml")
    shutil.move(folder / "deep" / "rest.yaml", folder / "missions" / "rest.yaml")
    (folder / "longarm.yaml").write_text(DEFAULTS + "paths: [.]\n")
    (folder / "deep" / "short.yaml").write_text("scenario: short\nmission: short\n")
    assert resolve_scenario(folder / "deep" / "short.yaml").mission.mission == "short"


def test_a_sub_tree_beside_the_tree_is_found(folder, capsys):
    (folder / "deep" / "outer.yaml").write_text(REST.format(name="outer", root='{rest: {route: "{route}"}}'))
    assert invoke(["check", str(folder / "deep" / "outer.yaml")]) == 0
    (folder / "deep" / "outer.yaml").write_text(REST.format(name="outer", root="rset"))
    assert invoke(["check", str(folder / "deep" / "outer.yaml")]) == 1
    assert 'did you mean "rest"?' in capsys.readouterr().out


def test_a_run_names_its_project_and_is_repeated_by_that(folder, tmp_path, capsys):
    (folder / "hello.py").write_text(LEAF.format(name="Hello", sibling="words"))
    (folder / "words.py").write_text("WORD = 'hello'\n")
    (folder / "longarm.yaml").write_text(DEFAULTS + "plugins: [hello.py]\n")
    (folder / "deep" / "rest.yaml").write_text(REST.format(name="rest", root="hello"))
    assert (
        invoke(["run", str(folder / "deep" / "short.yaml"), "--out", "out", "--quiet"]) == 1
    )  # no way-points
    dumped = (tmp_path / "out" / "scenario.yaml").read_text()
    assert "project: files/longarm.yaml\n" in dumped
    assert (tmp_path / "out" / "files" / "words.py").is_file()
    assert resolve_scenario(tmp_path / "out" / "scenario.yaml").tree.name == "rest"
    assert invoke(["show", "out"]) == 0
    assert "hello" in capsys.readouterr().out
    (folder / "longarm.yaml").unlink()
    (folder / "words.py").unlink()
    assert invoke(["run", "out/scenario.yaml", "--out", "again", "--quiet"]) == 1
    assert digest(tmp_path / "again" / "record.mcap") == digest(tmp_path / "out" / "record.mcap")


def test_two_projects_with_files_of_one_name_do_not_meet(tmp_path, capsys):
    """Each has its own helper, and neither knows the other's leaf."""
    for name in ("One", "Two"):
        folder = tmp_path / name
        folder.mkdir()
        (folder / "leaves.py").write_text(LEAF.format(name=name, sibling="words"))
        (folder / "words.py").write_text(f"WORD = {name!r}\n")
        (folder / "longarm.yaml").write_text("plugins: [leaves.py]\n")
        (folder / "tree.yaml").write_text(REST.format(name="tree", root=name.lower()))
    assert invoke(["check", str(tmp_path / "One" / "tree.yaml"), str(tmp_path / "Two" / "tree.yaml")]) == 0
    (tmp_path / "Two" / "tree.yaml").write_text(REST.format(name="tree", root="one"))
    assert invoke(["check", str(tmp_path / "One" / "tree.yaml"), str(tmp_path / "Two" / "tree.yaml")]) == 1
    assert 'got the unknown node "one"' in capsys.readouterr().out


def test_a_plug_in_shadows_no_module_of_its_name(tmp_path):
    (tmp_path / "json.py").write_text(
        "from longarm import ValueType\nMASS = ValueType('mass', float, 'kg')\n"
    )
    (tmp_path / "longarm.yaml").write_text("plugins: [json.py]\n")
    with registry.in_project(project_above(tmp_path)):
        kind = registry.kind_named("value_types")
        assert registry.get(kind, "mass").unit == "kg"
    import json as imported

    assert imported is json
    assert Path(imported.__file__).parent != tmp_path


def test_a_plug_in_may_look_up_what_it_has_defined(tmp_path):
    """It checks its own strategy at its end, whose tree uses its own leaf."""
    (tmp_path / "words.py").write_text("WORD = 'hello'\n")
    (tmp_path / "all.py").write_text(
        LEAF.format(name="Hello", sibling="words")
        + "\n\nfrom pathlib import Path\nfrom longarm import Strategy, check_strategy\n"
        "S = Strategy('greeting', 'Greets.', Path(__file__).with_name('greeting.yaml'), {},"
        " {Reason.NOT_SEEN: 0.5}, 20.0)\ncheck_strategy(S)\n"
    )
    (tmp_path / "greeting.yaml").write_text("tree: greeting\nroot: hello\n")
    (tmp_path / "longarm.yaml").write_text("plugins: [all.py]\n")
    with registry.in_project(project_above(tmp_path)):
        assert not registry.broken_modules()
        assert registry.get(registry.kind_named("strategies"), "greeting").name == "greeting"
