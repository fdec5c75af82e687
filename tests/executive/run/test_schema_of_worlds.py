import pytest
import yaml

from executive.config.backends import BACKEND_KIND
from executive.config.find import INSTALLED
from executive.config.project import read_project
from executive.core import registry
from executive.core.registry import in_project
from executive.run.schema import schema

SCENARIOS = sorted((INSTALLED / "scenarios").rglob("*.yaml"))


@pytest.fixture(scope="module")
def scenario():
    return schema("scenario")


def applied(scenario, file):
    """The schema of `world` that an editor holds this file against."""
    for rule in scenario["allOf"]:
        (wanted,) = rule["if"]["properties"].values()
        required = rule["if"].get("required", [])
        if file.get("backend", None if required else wanted["const"]) == wanted["const"]:
            reference = rule["then"]["properties"]["world"]["$ref"]
            return scenario["$defs"][reference.removeprefix("#/$defs/")]
    return None


def test_every_backend_has_its_own_world(scenario):
    for name, spec in registry.every(BACKEND_KIND).items():
        world = applied(scenario, {"backend": name})
        assert set(world["properties"]) == set(spec.world_model.model_fields)


def test_a_key_that_the_world_does_not_have_is_refused(scenario):
    for file in ({}, {"backend": "pybullet"}, {"backend": "fake"}):
        assert applied(scenario, file)["additionalProperties"] is False
    assert "terain" not in applied(scenario, {})["properties"]


def test_the_worlds_of_all_shipped_scenarios_are_known(scenario):
    worlds = [file for path in SCENARIOS if "world" in (file := yaml.safe_load(path.read_text()))]
    assert worlds
    for file in worlds:
        assert set(file["world"]) <= set(applied(scenario, file)["properties"])


def test_without_a_backend_the_projects_own_is_meant(tmp_path):
    (tmp_path / "longarm.yaml").write_text("defaults: {backend: fake}")
    with in_project(read_project(tmp_path / "longarm.yaml")):
        assert "advance" in applied(schema("scenario"), {})["properties"]
