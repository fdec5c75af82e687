"""What a backend has, against what trees and scenarios ask of it."""

import pytest

from executive.core.errors import ConfigError
from executive.record.events import DeviceReading
from executive.record.signals import listener, signals
from executive.run.check import check_file
from executive.run.resolve import resolve_scenario
from executive.testing import BACKEND, fake_with
from executive.tree.load import load_tree_text
from executive.tree.needs import missing, unfit
from executive.tree.strategies import load_strategies, strategy_trees

LOOKING = """\
tree: go
ports: {route: {type: Route}}
root:
  sequence:
    - localise: {pose: "{pose}"}
    - point_head: {pose: "{pose}"}
"""


ON_WHEELS = "backend: bare\nlocalizer: blind"


def test_a_node_without_its_device_is_a_problem_at_its_place(folder):
    (folder / "trees" / "go.yaml").write_text(LOOKING)
    scenario = folder / "scenarios" / "dark.yaml"
    assert check_file(scenario) == ()
    scenario.write_text(scenario.read_text().replace("backend: plain", ON_WHEELS))
    assert [str(problem) for problem in check_file(scenario)] == [
        'trees/go.yaml:6:7: point_head needs the device "head", which the backend bare does not have: '
        "battery, drive"
    ]


def test_a_device_that_serves_as_a_drive_is_enough_to_drive():
    tree = load_tree_text("tree: go\nroot: {localise: {pose: '{pose}'}}\n")
    assert missing(tree, fake_with("tracks")) == ()
    assert len(missing(tree, fake_with("cameras"))) == 1


def test_a_localizer_without_its_devices_or_rig_is_refused(folder):
    scenario = folder / "scenarios" / "dark.yaml"
    scenario.write_text(
        scenario.read_text().replace("backend: plain", "backend: bare\nlocalizer: led_stereo")
    )
    with pytest.raises(ConfigError) as caught:
        resolve_scenario(scenario)
    told = str(caught.value)
    assert "led_stereo needs cameras, head, cabin, inclinometer, which the backend bare does not have" in told
    assert "led_stereo needs a RigCalibration, the backend bare has a BareRig" in told


def test_a_strategy_without_its_devices_is_not_for_this_robot():
    trees = strategy_trees(load_strategies())
    assert unfit(trees, BACKEND) == {}
    found = unfit(trees, fake_with("tracks", "cameras"))
    assert found == {"cabin_reposing": "needs cabin, head, which this robot does not have"}


def test_the_rig_of_a_scenario_is_the_backends_own(folder):
    scenario = folder / "scenarios" / "dark.yaml"
    scenario.write_text(scenario.read_text().replace("backend: plain", ON_WHEELS))
    resolved = resolve_scenario(
        scenario, overrides=["rig.rover.track_gauge=28 cm", "rig.rover.tether_limit=4 N"]
    )
    assert resolved.rig.rover.track_gauge_m == pytest.approx(0.28)
    assert resolved.rig.rover.tether_limit_n == 4.0
    with pytest.raises(ConfigError, match='unknown key "head"'):
        resolve_scenario(scenario, overrides=["rig.head.mast_height=1.7 m"])


def test_a_rig_without_a_tether_is_dumped_without_a_limit(folder):
    scenario = folder / "scenarios" / "dark.yaml"
    scenario.write_text(scenario.read_text().replace("backend: plain", ON_WHEELS))
    resolved = resolve_scenario(scenario)
    assert "tether_limit" not in resolved.dump()
    (folder / "dumped.yaml").write_text(resolved.dump())
    assert resolve_scenario("dumped.yaml") == resolved


def test_what_a_plugged_in_device_reports_is_a_signal(folder):
    assert signals()["battery_charge"].doc == "what is left, 0 to 1"
    assert dict(listener()(DeviceReading("battery", {"charge": 0.5}))) == {"battery_charge": 0.5}
