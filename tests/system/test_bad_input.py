"""Bad input of every kind to the command line: located, all at once, exit 2, nothing written."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from executive.cli import invoke

LOCATED = re.compile(r"^\S+:[1-9]\d*:[1-9]\d*: \S.*$")

TREE = "tree: go\nports: {route: {type: Route}}\nroot: {wait: {duration: 1 s}}\n"
MISSION = """\
mission: short
tree: go
waypoints:
  - {x: 2.2 m, y: -0.5 m}
  - {x: 2.6 m, y: -0.4 m}
"""
SCENARIO = """\
scenario: short
mission: short
tier: geometric
"""
BOMB = "a0: &a0 [x, x, x, x, x, x, x, x]\n" + "".join(
    f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 8)}]\n" for i in range(1, 12)
)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A working folder with a tree, a mission and a scenario that are good."""
    monkeypatch.chdir(tmp_path)
    for kind, name, text in (
        ("trees", "go", TREE),
        ("missions", "short", MISSION),
        ("scenarios", "short", SCENARIO),
    ):
        (tmp_path / kind).mkdir()
        (tmp_path / kind / f"{name}.yaml").write_text(text)
    return tmp_path


def refused(capsys: pytest.CaptureFixture[str], *arguments: str) -> list[str]:
    """The complaints of a run that must be refused, everything about the refusal checked."""
    before = {path for path in Path.cwd().rglob("*") if path.name != "__pycache__"}
    assert invoke(["run", *arguments, "--out", "out"]) == 2
    told = capsys.readouterr()
    assert told.out == ""
    lines = told.err.splitlines()
    assert lines
    assert [line for line in lines if not LOCATED.match(line)] == []
    assert {path for path in Path.cwd().rglob("*") if path.name != "__pycache__"} == before
    return lines


def tree(root: str) -> str:
    return f"tree: go\nports: {{route: {{type: Route}}}}\nroot: {root}\n"


FILES = [
    ("unknown node", "trees/go", tree("{wiat: {}}"), 'trees/go.yaml:3:8: got the unknown node "wiat"'),
    ("unknown port", "trees/go", tree("{wait: {durtion: 1 s}}"), 'got the unknown port "durtion" of wait'),
    ("unknown unit", "trees/go", tree("{wait: {duration: 1 sek}}"), "trees/go.yaml:3:25: "),
    ("no unit", "trees/go", tree("{wait: {duration: 1}}"), "got 1 without a unit"),
    ("dimension", "trees/go", tree("{wait: {duration: 1 m}}"), "got '1 m' (a length), expected a duration"),
    ("recursion", "trees/go", tree("{go: {route: '{route}'}}"), "got a tree inside itself (go > go)"),
    ("guard", "trees/go", tree("{wait: {duration: 1 s}, while: '{x} <'}"), "trees/go.yaml:3:44: got "),
    ("wrong type", "trees/go", tree("5"), "trees/go.yaml:3:7: got 5, expected a node"),
    ("wrong type", "missions/short", MISSION.replace("2.6 m", "[2.6 m]"), "missions/short.yaml:5:9: got"),
    ("duplicate key", "trees/go", TREE + "tree: no\n", "trees/go.yaml:4:1: got the key 'tree' a second time"),
    ("missing file", "missions/short", MISSION.replace("go", "gone"),
     'got "gone", expected a file or a name'),
    ("missing file", "scenarios/short", SCENARIO.replace("mission: short", "mission: shrot"),
     'did you mean "short"?'),
    ("YAML bomb", "scenarios/short", BOMB, "aliases that expand to more than"),
    ("Python tag", "scenarios/short", "scenario: !!python/object/apply:os.system [touch owned]\n",
     "got the tag !!python/object/apply:os.system, expected plain YAML"),
    ("unreachable", "missions/short", MISSION.replace("2.6 m", "26 m"),
     "got an unreachable way-point, 26.00 m"),
    ("same place", "missions/short", MISSION.replace("2.6 m, y: -0.4", "2.2 m, y: -0.5"),
     "got the same place"),
    ("empty file", "scenarios/short", "", "scenarios/short.yaml:1:1: got an empty file"),
    ("comment only", "missions/short", "# soon\n", "missions/short.yaml:1:1: got an empty file"),
    ("binary junk", "scenarios/short", b"\x00\x01\xff\xfe" * 50, "short.yaml:1:3: got the byte 0xff"),
    ("control character", "trees/go", TREE.encode() + b"\x07", "which YAML does not allow"),
    ("not YAML", "scenarios/short", "scenario: [1, 2\nmission: }", "scenarios/short.yaml:2:"),
    ("two documents", "scenarios/short", SCENARIO + "---\n" + SCENARIO, "got a second document"),
    ("unknown backend", "scenarios/short", SCENARIO + "backend: pybulet\n", 'did you mean "pybullet"?'),
    ("unknown localizer", "scenarios/short", SCENARIO + "localizer: led_sterio\n",
     'scenarios/short.yaml:4:12: got the unknown localizer "led_sterio"'),
    ("unknown fault", "scenarios/short", SCENARIO + "faults: [{led_of: {}}]\n",
     'scenarios/short.yaml:4:11: got the unknown fault "led_of"'),
    ("tier of the backend", "scenarios/short", "scenario: s\nmission: short\ntier: full\nbackend: fake\n",
     'scenarios/short.yaml:3:7: got "full", expected a tier of fake'),
    ("unknown soil", "scenarios/short", SCENARIO + "world: {soil: {default: mud}}\n",
     "scenarios/short.yaml:4:"),
    ("negative seed", "scenarios/short", SCENARIO + "seed: -1\n", "scenarios/short.yaml:4:7: got -1"),
    ("not finite", "scenarios/short", SCENARIO + "time_limit: .inf\n", "expected a finite number"),
    ("absent elevation model", "scenarios/short", SCENARIO + "world: {terrain: {dem: none.tif}}\n",
     "scenarios/short.yaml:4:24: no such elevation model: "),
    ("terrain too small", "scenarios/short", SCENARIO + "world: {terrain: {procedural: {width: 4 m}}}\n",
     "missions/short.yaml:5:5: x 2.6 m is outside the terrain window (-2 … 2.02 m)"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("file", "content", "complaint"), [row[1:] for row in FILES], ids=[row[0] for row in FILES]
)
def test_a_bad_file_is_refused_with_its_place(
    folder: Path, capsys: pytest.CaptureFixture[str], file: str, content: str | bytes, complaint: str
) -> None:
    path = folder / f"{file}.yaml"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    lines = refused(capsys, "scenarios/short.yaml")
    assert any(complaint in line for line in lines), lines
    assert invoke(["check", "scenarios/short.yaml"]) == 1
    told = capsys.readouterr()
    assert told.err == ""
    assert told.out.splitlines() == lines


def test_many_problems_in_many_files_are_told_at_once(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "trees" / "go.yaml").write_text(tree("{sequence: [wiat, {wait: {duration: 1}}]}"))
    (folder / "missions" / "short.yaml").write_text(MISSION.replace("2.6 m", "26 m"))
    (folder / "scenarios" / "short.yaml").write_text(
        SCENARIO + "seed: x\nlocalizer: overhed\nbackend: fakee\ntimelimit: 3\n"
    )
    lines = refused(capsys, "scenarios/short.yaml")
    assert {line.split(":")[0] for line in lines} == {"trees/go.yaml", "scenarios/short.yaml"}
    assert len(lines) == 6
    (folder / "scenarios" / "short.yaml").write_text(SCENARIO)
    assert {line.split(":")[0] for line in refused(capsys, "scenarios/short.yaml")} == {
        "trees/go.yaml",
        "missions/short.yaml",
    }


@pytest.mark.parametrize(
    ("options", "complaint"),
    [
        (("--set", "seeed=3"), '--set:1:1: got the unknown key "seeed"'),
        (("--set", "world.lihgt.sun_elevation=3 deg"), 'did you mean "light"?'),
        (("--set", "seed=three"), '--set:1:6: got "three", expected a whole number'),
        (
            ("--set", "seed=3", "--set", "tier=ful"),
            '--set:2:6: got "ful", expected a tier of pybullet: full or geometric',
        ),
        (("--tier", "ful"), '--tier:1:1: got "ful", expected a tier of pybullet: full or geometric'),
        (("--set", "time_limit=3 m"), "--set:1:12: got '3 m' (a length)"),
        (("--set", "time_limit=3 h]"), "--set:1:"),
        (("--set", "seed"), '--set:1:1: got "seed", expected KEY=VALUE'),
        (("--set", "seed=!!python/name:os.system"), "--set:1:6: got the tag"),
        (("--set", "mission.waypoints.7.x=3 m"), "--set:1:1: got "),
        (("--set", "localizer=none"), '--set:1:11: got the unknown localizer "none"'),
        (("--set", "world.terrain.dem=none.npy"), "--set:1:19: no such elevation model"),
        (("--seed", "-1"), "--seed:1:1: got -1"),
        (("--seed", str(2**63)), "--seed:1:1: got 9223372036854775808"),
    ],
)
def test_a_bad_option_is_refused_with_its_place(
    folder: Path, capsys: pytest.CaptureFixture[str], options: tuple[str, ...], complaint: str
) -> None:
    lines = refused(capsys, "scenarios/short.yaml", *options)
    assert any(complaint in line for line in lines), lines


@pytest.mark.parametrize("content", ["- scenario\n", "scenario\n", "5\n", "~\n"])
def test_a_file_that_is_no_mapping_is_refused(
    folder: Path, capsys: pytest.CaptureFixture[str], content: str
) -> None:
    (folder / "scenarios" / "short.yaml").write_text(content)
    (line,) = refused(capsys, "scenarios/short.yaml")
    assert line.startswith("scenarios/short.yaml:1:1: got ")
    assert invoke(["check", "scenarios/short.yaml"]) == 1


@pytest.mark.parametrize(
    ("file", "complaint"),
    [
        ("none.yaml", "none.yaml:1:1: no such file"),
        ("trees", "trees:1:1: got a folder, expected a YAML file"),
        ("trees/go.yaml", "trees/go.yaml:1:1: "),
        ("scenarios/short.yaml/x", "scenarios/short.yaml/x:1:1: "),
    ],
)
def test_what_is_no_scenario_file_is_refused(
    folder: Path, capsys: pytest.CaptureFixture[str], file: str, complaint: str
) -> None:
    lines = refused(capsys, file)
    assert any(line.startswith(complaint) for line in lines), lines


@pytest.mark.parametrize(
    ("name", "content", "complaint"),
    [
        ("junk.tif", b"II*\x00junk", "not a readable TIFF"),
        ("junk.npy", b"\x93NUMPY junk", "not a readable array"),
        ("junk.png", b"", "got .png, expected .tif, .tiff or .npy"),
        ("words.npy", np.array([["a", "b"]] * 2), "not a readable array"),
        ("flat.npy", np.zeros(9), "got an array of shape (9,)"),
        ("holes.npy", np.full((9, 9), np.nan), "81 cells hold no height"),
    ],
)
def test_an_elevation_model_that_cannot_serve_is_refused(
    folder: Path, capsys: pytest.CaptureFixture[str], name: str, content: object, complaint: str
) -> None:
    model = folder / "scenarios" / name
    if isinstance(content, bytes):
        model.write_bytes(content)
    else:
        np.save(model, content)
    (folder / "scenarios" / "short.yaml").write_text(
        SCENARIO + f"world:\n  terrain:\n    dem: {name}\n    cell: 100 mm\n"
    )
    (line,) = refused(capsys, "scenarios/short.yaml")
    assert complaint in line
    assert line.startswith("scenarios/short.yaml:")


def test_a_way_point_beyond_the_elevation_model_is_named(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    np.save(folder / "scenarios" / "small.npy", np.zeros((60, 60)))
    terrain = "{dem: small.npy, cell: 100 mm, lander: {x: 1 m, y: 3 m}}"
    (folder / "missions" / "short.yaml").write_text(MISSION.replace("2.6", "6"))
    (folder / "scenarios" / "short.yaml").write_text(SCENARIO + f"world:\n  terrain: {terrain}\n")
    (line,) = refused(capsys, "scenarios/short.yaml")
    assert line.startswith("missions/short.yaml:5:5: x 6 m is outside the terrain window (-1 … ")


def test_a_missing_unit_is_the_only_problem_reported(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "missions" / "short.yaml").write_text(MISSION.replace("2.6 m", "2.6"))
    (line,) = refused(capsys, "scenarios/short.yaml")
    assert line.startswith("missions/short.yaml:5:9: got 2.6 without a unit")


def test_a_window_outside_the_elevation_model_is_refused(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    np.save(folder / "scenarios" / "flat.npy", np.zeros((200, 200)))
    terrain = "{dem: flat.npy, cell: 100 mm, window: {x: 15 m, y: 0 m, width: 12 m}}"
    (folder / "scenarios" / "short.yaml").write_text(SCENARIO + f"world:\n  terrain: {terrain}\n")
    (line,) = refused(capsys, "scenarios/short.yaml")
    assert line.startswith("scenarios/short.yaml:5:50: the window x 15.00..27.00 m")


@pytest.mark.parametrize("out", ["taken", "taken/inside"])
def test_an_output_folder_that_cannot_be_made_is_refused(
    folder: Path, capsys: pytest.CaptureFixture[str], out: str
) -> None:
    (folder / "taken").write_text("mine")
    assert invoke(["run", "scenarios/short.yaml", "--out", out]) == 2
    assert LOCATED.match(capsys.readouterr().err.rstrip("\n"))
    assert (folder / "taken").read_text() == "mine"


@pytest.mark.parametrize("command", ["report", "show"])
def test_a_run_folder_that_is_none_is_refused(
    folder: Path, capsys: pytest.CaptureFixture[str], command: str
) -> None:
    (folder / "empty").mkdir()
    assert invoke([command, "empty/"]) == 2
    assert "Traceback" not in capsys.readouterr().err
    assert list((folder / "empty").iterdir()) == []
