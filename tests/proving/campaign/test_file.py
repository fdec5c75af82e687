"""Campaign files: found, checked with every problem in its place, described for editors."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from executive.cli import invoke

ROOT = Path(__file__).resolve().parents[3]
BAD = """\
campaign: bad
scenario: first_traverse
runs: 0
teir: geometric
vary:
  world.light.sun_elevation: 30 deg
  world.terrain.procedural.rocks: {integer: [4, 2]}
  seed: {integer: [1, 2]}
grid: {world.lihgt: [1, 2]}
faults:
  number: 3
  from:
    - led_of: {marker: 1}
    - led_off: {marker: 9}
limits: {memory: 3}
"""


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def problems(text, capsys, folder):
    (folder / "bad.yaml").write_text(text)
    assert invoke(["check", "bad.yaml"]) == 1
    return capsys.readouterr().out.splitlines()


def test_problems_of_the_shape_are_all_told_in_their_place(folder, capsys):
    assert problems(BAD, capsys, folder) == [
        "bad.yaml:3:7: got 0, expected greater than or equal to 1",
        'bad.yaml:4:1: got the unknown key "teir", expected campaign, doc, scenario, seed, runs, tier, vary, '
        'grid, faults, compare, limits or stop; did you mean "tier"?',
        'bad.yaml:6:30: got "30 deg", expected a distribution: '
        "uniform, log_uniform, normal, integer or choice of something",
        'bad.yaml:8:3: got "seed", expected a key of the scenario other than seed, tier, time_limit '
        "or scenario",
        "bad.yaml:15:18: got 3, expected an amount of memory such as '3 GB'",
    ]


def test_problems_of_what_is_drawn_are_told_where_it_stands(folder, capsys):
    good = BAD.replace("runs: 0", "runs: 1").replace("teir", "tier").replace("memory: 3", "memory: 3 GB")
    lines = [line for line in good.splitlines() if "sun_elevation" not in line and "  seed:" not in line]
    text = "\n".join(lines)
    assert problems(text, capsys, folder) == [
        "bad.yaml:6:35: got a list of 2, expected two whole numbers, the first not the larger",
        "bad.yaml:9:11: got 3, expected a number of faults from 0 to 2, or a distribution",
    ]
    text = text.replace("[4, 2]", "[2, 4]").replace("number: 3", "number: 1")
    told = problems(text, capsys, folder)
    assert [line.split(":")[1] for line in told] == ["7", "7", "11", "12"], "each value of the grid"
    assert '"lihgt"' in told[0]
    assert told[2].startswith('bad.yaml:11:7: got the unknown fault "led_of"')
    assert told[2].endswith('did you mean "led_off"?')


def test_the_shipped_campaigns_have_no_problems(capsys, monkeypatch):
    monkeypatch.chdir(ROOT)
    files = sorted(str(path.relative_to(ROOT)) for path in (ROOT / "campaigns").glob("*.yaml"))
    assert len(files) >= 3
    assert invoke(["check", *files]) == 0, capsys.readouterr().out


def test_the_schema_of_a_campaign_is_json_schema_with_the_scenario_in_it(capsys):
    assert invoke(["schema", "campaign"]) == 0
    made = json.loads(capsys.readouterr().out)
    assert made["$schema"].startswith("https://json-schema.org/")
    assert "campaign" in made["required"]
    assert made["properties"]["scenario"]["anyOf"][1]["properties"]["mission"]
    assert "MissionFile" in made["$defs"]
