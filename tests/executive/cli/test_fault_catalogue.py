"""The catalogue of faults, as people and editors get it."""

import json

import pytest

from executive.cli import invoke
from executive.config.describe import parameters
from executive.core import registry
from executive.run.fault import FAULT_KIND
from executive.run.schema import schema


@pytest.fixture(scope="module")
def scenario():
    return schema("scenario")


def kinds(scenario):
    """The schema of each kind of fault, by name."""
    return {one["required"][0]: one for one in scenario["$defs"]["fault"]["oneOf"]}


def test_a_fault_tells_its_parameters_with_units_and_defaults(capsys):
    assert invoke(["faults", "pose_outlier"]) == 0
    told = capsys.readouterr().out
    assert told.startswith("pose_outlier  (estimation)\n")
    assert "  x: a length such as 30 mm, default 0.3 m   along site x\n" in told
    assert "  profiles: step, ramp, intermittent, random\n" in told
    assert "  tiers: any\n  backends: any\n  hypothesis: localisation_outlier\n" in told


def test_a_fault_tells_where_it_can_act_and_what_must_be_said(capsys):
    assert invoke(["faults", "rock_on_path"]) == 0
    told = capsys.readouterr().out
    assert "  profiles: step\n  lasting: True\n" in told
    assert "  backends: pybullet\n" in told
    assert invoke(["faults", "encoder_stuck"]) == 0
    assert "  side: left or right, required   which track\n" in capsys.readouterr().out


def test_optional_numbers_and_lists_are_shown_with_their_bounds(capsys):
    assert invoke(["faults", "led_dim"]) == 0
    out = capsys.readouterr().out
    assert "  marker: integer 0–3, optional   one LED, counted from 0\n" in out
    assert "  markers: list of 1–4 integers 0–3, optional" in out


def test_a_default_is_written_as_a_file_would_have_it():
    from proving.faults.estimation import Shift

    x, _ = parameters(Shift)
    assert (x.name, x.default, x.required) == ("x", "0.3 m", False)
    assert Shift(x=x.default) == Shift()


def test_editors_know_the_parameters_of_every_installed_fault(scenario):
    known = kinds(scenario)
    assert set(known) == set(registry.names(FAULT_KIND))
    hanging = known["node_hangs"]["properties"]["node_hangs"]
    assert (hanging["required"], hanging["additionalProperties"]) == (["node"], False)
    shift, drawn = known["pose_outlier"]["properties"]["pose_outlier"]["properties"]["x"]["anyOf"]
    assert (shift["default"], shift["examples"]) == ("0.3 m", ["30 mm"])
    assert drawn == {"$ref": "#/$defs/distribution"}


def test_editors_know_what_every_fault_may_have_beside(scenario):
    beside = {"from", "for", "profile", "name", "cause"}
    assert set(kinds(scenario)["frozen_frame"]["properties"]) == beside | {"frozen_frame"}
    assert set(kinds(scenario)["process_killed"]["properties"]) == beside - {"for"} | {"process_killed"}
    assert set(scenario["$defs"]["group"]["properties"]) == {"group", "faults", "from", "for", "profile"}
    assert "progress" in scenario["$defs"]["trigger"]["properties"]


def test_every_reference_of_the_schema_is_there(scenario):
    def references(part):
        if isinstance(part, dict):
            yield from ([part["$ref"]] if isinstance(part.get("$ref"), str) else [])
            part = list(part.values())
        for inner in part if isinstance(part, list) else ():
            yield from references(inner)

    defs = {f"#/$defs/{name}" for name in scenario["$defs"]}
    assert set(references(scenario)) <= defs
    assert json.loads(json.dumps(scenario)) == scenario
