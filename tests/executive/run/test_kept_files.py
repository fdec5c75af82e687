"""A run folder repeats anywhere: it holds the files that were used, and says what has become of them."""

from __future__ import annotations

import json

import pytest

from executive.record import digest
from executive.run.app import RunOptions, run
from executive.run.kept_files import changes

MISSION = """\
scenario: kept
backend: fake
localizer: overhead
tier: geometric
mission:
  mission: m
  tree: {tree}
  waypoints: [{{x: 2.0 m, y: 0 m}}, {{x: 2.1 m, y: 0 m}}]
"""
OUTER = """\
tree: outer
ports: {{route: {{type: Route, direction: in}}}}
root:
  sequence:
    - {sub}: {{}}
    - navigate: {{route: "{{route}}"}}
"""
SUB = "tree: {name}\nroot: {{wait: {{duration: 5 s}}}}\n"


@pytest.fixture(params=["beside", "by path", "in a project"])
def source(request, tmp_path):
    """A scenario whose own tree uses another one of the user's."""
    home = tmp_path / "mine"
    inner = home / ("lib" if request.param == "by path" else "trees")
    inner.mkdir(parents=True)
    (inner / "pause.yaml").write_text(SUB.format(name="pause"))
    sub = "../lib/pause.yaml" if request.param == "by path" else "pause"
    outer = home / "trees" / "outer.yaml"
    outer.parent.mkdir(exist_ok=True)
    outer.write_text(OUTER.format(sub=sub))
    if request.param == "in a project":
        (home / "longarm.yaml").write_text("paths: [.]\n")
    scenario = home / "s.yaml"
    scenario.write_text(
        MISSION.format(tree="outer" if request.param == "in a project" else "trees/outer.yaml")
    )
    return scenario


def test_a_run_repeats_bit_for_bit_after_a_move_and_without_its_sources(source, tmp_path):
    first = run(source, RunOptions(out=source.parent / "run", bar=False, report=False))
    assert first.result.outcome == "reached"
    moved = tmp_path / "elsewhere" / "run"
    moved.parent.mkdir()
    (source.parent / "run").rename(moved)
    source.parent.rename(tmp_path / "gone")
    again = run(moved / "scenario.yaml", RunOptions(out=tmp_path / "again", bar=False, report=False))
    assert digest(again.folder / "record.mcap") == digest(moved / "record.mcap")
    assert str(tmp_path) not in (again.folder / "scenario.yaml").read_text()
    assert changes(moved) == ()


def test_what_was_changed_since_is_told_with_its_line(source):
    done = run(source, RunOptions(out=source.parent / "run", bar=False, report=False))
    assert changes(done.folder) == ()
    pause = next(source.parent.rglob("pause.yaml"))
    if "files" in pause.parts:
        pause = next(path for path in source.parent.rglob("pause.yaml") if "files" not in path.parts)
    pause.write_text(pause.read_text().replace("5 s", "6 s"))
    assert changes(done.folder) == ("tree pause.yaml: line 2",)


def test_what_came_with_longarm_is_kept_for_comparison_only(source):
    done = run(source, RunOptions(out=source.parent / "run", bar=False, report=False))
    listing = json.loads((done.folder / "files" / "manifest.json").read_text())["files"]
    installed = {entry["name"] for entry in listing if "/installed/" in (entry["copy"] or "")}
    assert {"navigate.yaml", "trek_to.yaml", "back_off.yaml"} <= installed
