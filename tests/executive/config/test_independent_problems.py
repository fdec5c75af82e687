"""No problem of a file hides another, and each is told once."""

from __future__ import annotations

import itertools
from pathlib import Path

import pytest
import yaml

from executive.core.errors import ConfigError
from executive.run.check import check_file
from executive.run.resolve import resolve_scenario

SCENARIO = {
    "scenario": "two",
    "seed": 1,
    "tier": "geometric",
    "time_limit": "2 h",
    "mission": {
        "mission": "m",
        "tree": "navigate",
        "segments": {"on_track": "30 mm", "off_track": "250 mm", "tolerance": "30 mm"},
        "waypoints": [{"x": "2 m", "y": "0 m"}, {"x": "2.4 m", "y": "0 m"}],
    },
    "world": {"mast_height": "1.5 m"},
    "faults": [{"led_off": {"marker": 1}, "from": {"time": "5 min"}}],
    "expect": {"outcome": "reached"},
}
OF_SCENARIOS = {
    ("mission",): ("no_such_mission", "no_such_mission"),
    ("seed",): ("off", '"off"'),
    ("tier",): ("full_or_so", "full_or_so"),
    ("time_limit",): (5, "5 without a unit"),
    ("mission", "tree"): ("navigat", "navigat"),
    ("mission", "segments", "on_track"): ("30 kg", "30 kg"),
    ("mission", "waypoints", 1, "x"): ("nan m", "nan m"),
    ("world", "mast_height"): ("high", "high"),
    ("faults", 0, "led_off", "marker"): (-7, "-7"),
    ("faults", 0, "from", "time"): ("soon", "soon"),
    ("expect", "outcome"): ("reachd", "reachd"),
    ("polcy",): ("first_fitted", "polcy"),
    ("backend",): ("pybulet", "pybulet"),
    ("localizer",): ("led_stere", "led_stere"),
}
HIDDEN_BY = {
    "backend": ("world", "tier", "localizer"),
    "tier": ("localizer",),
    "mission": ("mission",),
}
"""What cannot be judged without another key, by that key."""
TREE = {
    "tree": "a",
    "doc": "A tree.",
    "ports": {
        "route": {"type": "Route", "direction": "in"},
        "pose": {"type": "PoseEstimate", "direction": "out"},
    },
    "root": {
        "sequence": [{"wait": {"duration": "1 s"}}, {"localise": {"quality": "precise", "pose": "{pose}"}}]
    },
}
OF_TREES = {
    ("ports", "route", "type"): ("Rute", "Rute"),
    ("ports", "route", "direction"): ("into", "into"),
    ("ports", "pose", "typ"): ("x", '"typ"'),
    ("root", "sequence", 0, "wait", "duration"): ("1 m", "1 m"),
    ("root", "sequence", 1, "localise", "quality"): ("precisely", "precisely"),
    ("root", "sequence", 1, "while"): ("1 <", "the end"),
    ("dok",): ("x", "dok"),
}


NUMBERS = [("time_limit",), ("mission", "waypoints", 1, "x"), ("seed",), ("world", "mast_height")]


def spoilt(data: dict, edits: dict) -> dict:
    made = yaml.safe_load(yaml.safe_dump(data))
    for place, (value, _) in edits.items():
        inner = made
        for step in place[:-1]:
            inner = inner[step]
        inner[place[-1]] = value
    return made


def told(folder: Path, data: dict) -> list[str]:
    file = folder / "file.yaml"
    file.write_text(yaml.safe_dump(data, sort_keys=False))
    return [str(problem) for problem in check_file(file) if not problem.warning]


def pairs(edits: dict) -> list[tuple]:
    """Every two edits of which neither takes away the other, or what the other is judged by."""
    return [(a, b) for a, b in itertools.combinations(edits, 2) if not (hides(a, b) or hides(b, a))]


def hides(one: tuple, other: tuple) -> bool:
    return len(one) == 1 and other[0] in HIDDEN_BY.get(one[0], ())


@pytest.mark.parametrize(
    ("data", "edits", "pair"),
    [
        *((SCENARIO, OF_SCENARIOS, pair) for pair in pairs(OF_SCENARIOS)),
        *((TREE, OF_TREES, pair) for pair in pairs(OF_TREES)),
    ],
)
def test_of_two_problems_both_are_told_and_each_once(tmp_path, data, edits, pair):
    assert told(tmp_path, data) == []
    found = told(tmp_path, spoilt(data, {place: edits[place] for place in pair}))
    assert len(found) == len({message.split(": ", 1)[0] for message in found}) == 2, found
    for place in pair:
        assert sum(edits[place][1] in message for message in found) == 1, found


@pytest.mark.parametrize("text", [".nan", ".inf", "-.INF", "1e400"])
@pytest.mark.parametrize("place", NUMBERS)
def test_a_number_that_is_none_is_told_once_at_its_place(tmp_path, text, place):
    data = yaml.safe_dump(spoilt(SCENARIO, {place: ("NUMBER", "")}), sort_keys=False).replace("NUMBER", text)
    (tmp_path / "file.yaml").write_text(data)
    (problem,) = check_file(tmp_path / "file.yaml")
    line = next(number for number, line in enumerate(data.splitlines(), 1) if text in line)
    assert (problem.line, problem.message) == (line, f"got {text}, expected a finite number")


@pytest.mark.parametrize("overrides", [(), ("seed=3",), ("world.mast_height=1 m",)])
def test_a_run_of_a_scenario_without_its_mission_says_so_once(tmp_path, overrides):
    file = tmp_path / "file.yaml"
    file.write_text(yaml.safe_dump(SCENARIO | {"mission": "no_such_mission"}, sort_keys=False))
    with pytest.raises(ConfigError) as refused:
        resolve_scenario(file, 1, "geometric", overrides)
    assert len(refused.value.problems) == 1


@pytest.mark.parametrize("value", [".nan", "1e400"])
def test_an_override_that_is_no_number_is_told_once(tmp_path, value):
    file = tmp_path / "file.yaml"
    file.write_text(yaml.safe_dump(SCENARIO, sort_keys=False))
    with pytest.raises(ConfigError) as refused:
        resolve_scenario(file, overrides=(f"time_limit={value}",))
    assert len(refused.value.problems) == 1
