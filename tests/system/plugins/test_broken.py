"""A broken one of every kind is named with its source and reason, and only what uses it fails."""

import json

import pytest

from executive.cli import invoke
from executive.record import History
from executive.record.events import Command, LogEvent
from tests.system.plugins.conftest import ADDED, HERE, install

BROKEN = {
    "value_types": ("mass", 'ValueType("mass", dict)', "value type mass: a dict has no literals"),
    "leaves": ("weigh_sample", 'type("WeighSample", (Leaf,), {})', "leaf weigh_sample: it does not say what"),
    "control_nodes": (
        "once",
        'type("Once", (ControlNode,), {})',
        "control node once: it does not say what it does",
    ),
    "backends": (
        "twin",
        'BackendSpec("twin", "A robot.", dict, (), ("drive",), dict, dict)',
        "backend twin: it plays no tier",
    ),
    "faults": (
        "hum",
        'FaultSpec("hum", "Hums.", object, dict, "hummed")',
        'fault hum: unknown hypothesis "hummed", expected nominal',
    ),
    "strategies": (
        "sit_still",
        'Strategy("sit_still", "Sits.", Path("/nowhere.yaml"), {}, {Reason.NOT_SEEN: 0.5}, 20.0)',
        "strategy sit_still: tree file not found: /nowhere.yaml (is it in package-data?)",
    ),
    "devices": (
        "thermometer",
        'DeviceSpec("thermometer", "", object)',
        "device thermometer: it does not say what it is",
    ),
    "signals": ("heat", 'Signal("heat", TEXT, (), print, "Heat.")', "signal heat: a text is no number"),
    "channels": (
        "bumps",
        'Channel("bumps", "", "", Gaussian(0, 1), print)',
        "channel bumps: it does not say what",
    ),
    "hypotheses": (
        "rough_ground",
        'Hypothesis("rough_ground", "Rough.", {"bumps": Gaussian(5.0, 2.0)})',
        "hypothesis rough_ground: it speaks about 'bumps', expected a channel: ",
    ),
    "policies": ("last_first", "3", "policy last_first: got an int, expected a Policy"),
    "instruments": ("watcher", "3", "instrument watcher: got an int, expected an InstrumentSpec"),
    "files": ("recipe", "3", "file kind recipe: got an int, expected a FileKind"),
    "reporters": (
        "recipe",
        "print",
        "reporter recipe: got a builtin_function_or_method, expected a Reporter",
    ),
    "commands": ("greet", "print", "command greet: got a builtin_function_or_method, expected a Command"),
    "localizers": ("overhead_too", "3", "localizer overhead_too: got an int, expected a LocalizerSpec"),
}
"""Kind → name, what stands there instead, and what is said of it. A new kind joins by one line."""
HEAD = "from pathlib import Path\nfrom longarm import *\n"
AT_REST = 1
"""The exit code of a run whose tree does its work, but reports no way-point."""
PLAIN = """\
scenario: plain
backend: fake
localizer: overhead
tier: geometric
time_limit: 1 h
mission: {mission: plain, tree: rest, waypoints: [{x: 2.2 m, y: -0.5 m}, {x: 2.4 m, y: -0.5 m}]}
"""
REST = "tree: rest\nports: {route: {type: Route}}\nroot: {wait: {duration: 5 s}}\n"


@pytest.fixture
def plain(bring_in):
    """A folder with a scenario that needs no plug-in, and a plug-in with this text and these entries."""

    def make(text, added, way="entry points"):
        folder = bring_in(way, HEAD + text, added)
        (folder / "plain.yaml").write_text(PLAIN)
        (folder / "rest.yaml").write_text(REST)
        return folder

    return make


def test_every_kind_is_tried():
    assert set(BROKEN) == set(ADDED)


@pytest.mark.parametrize("kind", BROKEN)
def test_a_broken_one_is_named_and_the_others_listed(plain, kind, capsys):
    name, value, reason = BROKEN[kind]
    plain(f"THING = {value}\n", {kind: (name, "THING")})
    assert invoke([kind.replace("_", "-"), "--json"]) == 0
    out, err = capsys.readouterr()
    assert name not in json.loads(out)
    assert f"longarm: cannot be used: {reason}" in err
    assert f"(entry point longarm.{kind}: {name} = stranger:THING)" in err
    assert invoke(["plugins"]) == 0
    assert reason in capsys.readouterr().err


@pytest.mark.parametrize("kind", BROKEN)
def test_what_does_not_use_a_broken_one_works(plain, kind, capsys):
    name, value, _ = BROKEN[kind]
    plain(f"THING = {value}\n", {kind: (name, "THING")})
    assert invoke(["check", "plain.yaml", "rest.yaml"]) == 0
    assert invoke(["show", "rest.yaml"]) == 0
    for schema in ("tree", "scenario"):
        assert invoke(["schema", schema]) == 0
    assert invoke(["run", "plain.yaml", "--out", "out", "--quiet"]) == AT_REST
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("kind", BROKEN)
def test_asking_for_a_broken_one_is_bad_input(plain, kind, capsys):
    name, value, reason = BROKEN[kind]
    plain(f"THING = {value}\n", {kind: (name, "THING")})
    assert invoke([kind.replace("_", "-"), name]) == 2
    assert capsys.readouterr().err.startswith(reason)


USES = {
    "value_types": ("weigh.yaml", "3:44"),
    "leaves": ("weigh.yaml", "6:7"),
    "control_nodes": ("weigh.yaml", "9:7"),
    "backends": ("outside.yaml", "3:10"),
    "faults": ("outside.yaml", "14:5"),
    "strategies": ("outside.yaml", "16:33"),
    "policies": ("outside.yaml", "8:9"),
    "instruments": ("outside.yaml", "1:1"),
    "localizers": ("outside.yaml", "4:12"),
}
"""Kind → a file that uses it, and where."""


@pytest.mark.parametrize("kind", USES)
def test_a_file_that_uses_a_broken_one_says_so_at_its_place(plain, kind, capsys):
    name, value, reason = BROKEN[kind]
    folder = plain(f"THING = {value}\n", {kind: (name, "THING")})
    outside = folder / "outside.yaml"
    outside.write_text(outside.read_text().replace("localizer: overhead\n", "localizer: overhead_too\n"))
    file, place = USES[kind]
    assert invoke(["check", "outside.yaml", "weigh.yaml"]) == 1
    told = capsys.readouterr().out.splitlines()
    assert any(line.startswith(f"{file}:{place}: ") and reason in line for line in told), told
    assert invoke(["run", "outside.yaml", "--out", "out"]) == 2
    assert not (folder / "out").exists()


@pytest.mark.parametrize(("command", "reason"), [("greet", "command greet"), ("report", "reporter recipe")])
def test_a_command_that_needs_a_broken_one_says_so(plain, command, reason, capsys):
    added = {kind: (BROKEN[kind][0], "print") for kind in ("commands", "reporters")}
    folder = plain("print = print\n", added)
    (folder / "recipe.json").write_text("{}")
    assert invoke(["--help"]) == 0
    assert invoke([command] if command == "greet" else [command, "."]) == 2
    assert capsys.readouterr().err.startswith(f"{reason}: got a builtin_function_or_method")


def test_a_module_that_cannot_be_imported_is_named(plain, capsys):
    folder = plain("import no_such_module\n", {}, "project")
    assert invoke(["run", "plain.yaml", "--out", "out", "--quiet"]) == AT_REST
    reason = (
        "ModuleNotFoundError: No module named 'no_such_module' (stranger.py:3) (longarm.yaml: stranger.py)"
    )
    assert invoke(["strategies"]) == 0
    assert f"longarm: cannot be used: {reason}\n" in capsys.readouterr().err
    (folder / "rest.yaml").write_text("tree: rest\nroot: weigh_sample\n")
    assert invoke(["check", "rest.yaml"]) == 1
    told = capsys.readouterr().out
    assert told.startswith('rest.yaml:2:1: got the unknown node "weigh_sample", expected a node or a tree')
    assert told.endswith(f"; not loaded: {reason}\n")


def test_a_file_that_does_not_parse_is_named_with_its_line(plain, capsys):
    plain("class Weigh(\n", {}, "project")
    assert invoke(["leaves"]) == 0
    assert "SyntaxError: '(' was never closed (stranger.py:3)" in capsys.readouterr().err


def test_a_name_taken_twice_is_of_no_use_to_either(plain, tmp_path, monkeypatch, capsys):
    plain((HERE / "stranger.py").read_text(), ADDED)
    install(tmp_path / "other", "rival", "[longarm.faults]\nhum = proving.faults:POSE_NAN\n")
    monkeypatch.syspath_prepend(str(tmp_path / "other"))
    assert invoke(["faults", "hum"]) == 2
    told = capsys.readouterr().err
    assert "registered twice" in told
    assert "hum = proving.faults:POSE_NAN" in told
    assert "hum = stranger:HUM" in told
    assert invoke(["faults", "led_off"]) == 0


def test_the_pool_does_without_a_strategy_whose_tree_is_bad(plain, capsys):
    folder = plain(
        'STRATEGY = Strategy("sit_still", "Sits.", Path(__file__).with_name("sit_still.yaml"),'
        " {}, {Reason.NOT_SEEN: 0.5}, 20.0)\n",
        {},
        "project",
    )
    (folder / "sit_still.yaml").write_text("tree: sit_still\nroot: {wait: {duration: 5 m}}\n")
    assert invoke(["run", "plain.yaml", "--out", "out"]) == AT_REST
    told = capsys.readouterr().err
    assert told.startswith("longarm: the run does without strategy sit_still: sit_still.yaml:2:25: got ")
    assert "(longarm.yaml: stranger.py)\n" in told
    assert invoke(["explain", "out"]) == 0
    logged = History.of(folder / "out" / "record.mcap").all(LogEvent)
    assert any("does without strategy sit_still" in at.event.message for at in logged)
    (folder / "plain.yaml").write_text(PLAIN + "expect: {strategies_not_tried: [sit_still]}\n")
    capsys.readouterr()
    assert invoke(["check", "plain.yaml"]) == 1
    assert "plain.yaml:7:33: strategy sit_still: sit_still.yaml:2:25: got " in capsys.readouterr().out


LAMP = """
from dataclasses import replace

from executive.testing import BACKEND
from longarm import Devices, DeviceSpec, Verb


class _Lamp:
    def off(self):
        Path("off.txt").write_text("off")


LAMP = DeviceSpec("lamp", "A lamp.", _Lamp, verbs=(Verb("off"),), rest=lambda lamp: lamp.off())


def _create(request):
    backend = BACKEND.create(request)
    backend.devices = Devices(*backend.devices, LAMP.fit(_Lamp()))
    return backend


LIT = replace(BACKEND, name="lit", devices=(*BACKEND.devices, "lamp"), create=_create)
"""


def test_a_device_of_a_plug_in_is_brought_to_rest_in_the_end(plain):
    folder = plain(LAMP, {}, "project")
    (folder / "plain.yaml").write_text(PLAIN.replace("backend: fake", "backend: lit"))
    assert invoke(["run", "plain.yaml", "--out", "out", "--quiet"]) == AT_REST
    assert (folder / "off.txt").read_text() == "off"
    commands = History.of(folder / "out" / "record.mcap").all(Command)
    assert [at.event.verb for at in commands if at.event.device == "lamp"] == ["off"]


def test_a_leaf_that_raises_in_a_run_is_a_defect(plain, capsys):
    folder = plain(
        "class Burst(Leaf):\n    'Bursts.'\n    def step(self):\n        raise ValueError('burst')\n",
        {},
        "project",
    )
    (folder / "rest.yaml").write_text("tree: rest\nports: {route: {type: Route}}\nroot: burst\n")
    assert invoke(["run", "plain.yaml", "--out", "out", "--quiet"]) == 3
    assert "ValueError: burst" in capsys.readouterr().err
    assert "stranger.py" in (folder / "out" / "traceback.txt").read_text()
