import re
from pathlib import Path

import pytest
import yaml

from executive.core.errors import ConfigError
from executive.isc import hypothesis_names
from executive.record.signals import signals
from executive.run.resolve import resolve_scenario
from proving.judge import INSTRUMENT


def resolved(folder, expect, more=""):
    path = folder / "scenarios" / "dark.yaml"
    head = path.read_text().split("expect:")[0]
    path.write_text(f"{head}{more}expect:\n{expect}")
    return resolve_scenario("scenarios/dark.yaml")


def problems(folder, expect):
    with pytest.raises(ConfigError) as caught:
        resolved(folder, expect)
    return str(caught.value).splitlines()


def test_what_stands_alone_is_a_list_of_one(folder):
    single = (
        resolved(folder, "  outcome: help\n  always: tilt < 5 deg\n  detected: {fault: lamp_off}\n")
        .of(INSTRUMENT)
        .expect
    )
    several = (
        resolved(folder, "  outcome: [help]\n  always: [tilt < 5 deg]\n  detected: [{fault: lamp_off}]\n")
        .of(INSTRUMENT)
        .expect
    )
    assert single == several
    assert single.outcome == ("help",)


def test_every_form_survives_the_dump(folder):
    scenario = resolved(
        folder,
        "  outcome: [reached, error]\n  max_tether: {below: 2 N}\n  max_cross_track: {below: 1 cm}\n"
        "  at_rest: true\n  recovered: {fault: lamp_off, within: 2 min}\n"
        "  diagnosed: [{fault: lamp_off, as: marker_lost}, {fault: lamp_off, as: poor_view, within: 1 h}]\n"
        "  until: moving until[0 s, 1 h] waypoint == 3\n  holds: [not eventually tilt > 9 deg]\n",
        more="expected_to_fail: nobody watches the tether yet\n",
    )
    (folder / "again.yaml").write_text(scenario.dump())
    again = resolve_scenario(folder / "again.yaml")
    assert again == scenario
    assert again.of(INSTRUMENT).expected_to_fail == "nobody watches the tether yet"
    assert yaml.safe_load(scenario.dump())["expect"]["max_tether"] == {"below": "2.0 N"}


@pytest.mark.parametrize(
    ("expect", "problem"),
    [
        ("  always: tilt < 5 mm\n", "11:18: got a length, expected an angle to compare with '<'"),
        (
            '  eventually: "moving and tlt < 5 deg"\n',
            "11:27: got 'tlt', expected a number, a signal or (...); did you mean \"tilt\"?",
        ),
        (
            "  holds: [moving, 'always[3, 5 s] moving']\n",
            "11:27: got 3 without a unit, expected a duration such as '36 s'",
        ),
        (
            "  until: moving\n",
            "11:10: got no until, expected a formula such as 'moving until remaining < 30 mm'",
        ),
        (
            "  detected: {fault: lamp_of}\n",
            '11:21: got the unknown fault "lamp_of", expected lamp_off; did you mean "lamp_off"?',
        ),
        (
            "  strategies_tried: [back_of]\n",
            '11:22: got the unknown strategy "back_of", expected back_off, cabin_reposing, fresh_look, '
            'overshoot_avoidance, turning_slip_compensation or wait_for_sight; did you mean "back_off"?',
        ),
        ("  at_rest: false\n", "11:12: got false, expected true"),
        (
            "  recovered: {falt: lamp_off}\n",
            '11:15: got the unknown key "falt", expected fault or within; did you mean "fault"?',
        ),
    ],
)
def test_what_cannot_be_judged_is_told_at_its_place(folder, expect, problem):
    assert f"scenarios/dark.yaml:{problem}" in problems(folder, expect)


def test_an_unknown_hypothesis_is_told_with_a_guess(folder):
    (found,) = problems(folder, "  diagnosed: {fault: lamp_off, as: marker_lots}\n")
    assert found.startswith(
        'scenarios/dark.yaml:11:36: got the unknown hypothesis "marker_lots", expected nominal'
    )
    assert found.endswith('did you mean "marker_lost"?')


def test_every_complaint_about_expectations_comes_at_once(folder):
    expect = "  outcome: reachd\n  always: tilt\n  diagnosed: {fault: a, as: b}\n  strategies_tried: c\n"
    assert [line.split(":")[1] for line in problems(folder, expect)] == ["11", "12", "13", "13", "14"]


MANUAL = Path(__file__).parents[3] / "docs" / "expectations.md"


def test_what_the_manual_shows_can_be_expected(folder):
    (folder / "trees" / "go.yaml").unlink()  # the manual speaks of nodes of the shipped tree
    mission = folder / "missions" / "short.yaml"
    mission.write_text(mission.read_text().replace("tree: go", "tree: navigate"))
    (shown,) = re.findall(r"```yaml\nexpect:\n(.*?)```", MANUAL.read_text(), re.DOTALL)
    path = folder / "scenarios" / "dark.yaml"
    path.write_text(path.read_text().replace("{marker: 2}\n", "{marker: 2}\n    name: led_off\n"))
    expect = resolved(folder, shown).of(INSTRUMENT).expect
    assert all(value not in (None, ()) for value in expect.model_dump().values())


def test_the_manual_names_every_signal():
    named = set(
        re.findall(r"`(\w+)`", MANUAL.read_text().split("| signal | of |")[1].split("### Exactly")[0])
    )
    assert set(signals()) - named <= set(hypothesis_names())
    assert named <= set(signals())
