import pytest

from executive.core.errors import PluginError
from executive.run.fault import load_fault

FAULT = """
from pydantic import BaseModel
from executive.run.fault import Fault, FaultSpec

SPEC = FaultSpec("lamp", "A lamp goes out.", BaseModel, lambda lamp: Fault(), "marker_lots")
"""


def test_a_fault_of_an_unknown_hypothesis_is_a_broken_plug_in(install):
    install(FAULT, "[longarm.faults]\nlamp = planted_plugin:SPEC\n")
    with pytest.raises(PluginError, match=r'fault lamp: unknown hypothesis "marker_lots".*"marker_lost"'):
        load_fault("lamp")


@pytest.mark.parametrize(
    ("graded", "lasting", "profiles"),
    [
        (False, False, ("step", "intermittent", "random")),
        (True, False, ("step", "ramp", "intermittent", "random")),
        (True, True, ("step", "ramp")),
    ],
)
def test_profiles_follow_from_what_a_fault_can_do(install, graded, lasting, profiles):
    more = f'"marker_lost", graded={graded}, lasting={lasting})'
    install(FAULT.replace('"marker_lots")', more), "[longarm.faults]\nlamp = planted_plugin:SPEC\n")
    assert load_fault("lamp").profiles == profiles
