"""The checkers of control nodes, devices and policies accept what is registered and name what is broken."""

import pytest

from executive.core.device_spec import DeviceSpec, Quantity, Verb
from executive.core.registry import every
from executive.core.values import NUMBER
from executive.pool import Decision, Policy
from executive.pool.known import POLICY_KIND
from executive.testing import (
    DeviceBreach,
    NodeBreach,
    PolicyBreach,
    check_device,
    check_node,
    check_policy,
)
from executive.tree.nodes.control import Children, ControlNode
from executive.tree.nodes.kind import CONTROL_KIND
from tests.executive.pool.test_pool import BACK, TURN, situation


class Lamp:
    def light(self):
        """On."""

    def read(self):
        return 1.0


class Stumbles(ControlNode):
    """Cannot be made."""

    children = Children.ONE

    def make(self, children, context):
        raise ValueError("stumbled")


LAMP = DeviceSpec("lamp", "A lamp.", Lamp, (Quantity("power", NUMBER, "of it", float),), (Verb("light"),))


@pytest.mark.parametrize("node", every(CONTROL_KIND).values())
def test_every_control_node_there_is_passes(node):
    check_node(node)


def test_a_control_node_that_raises_is_named():
    with pytest.raises(NodeBreach, match=r"control node stumbles: .*ValueError: stumbled"):
        check_node(Stumbles)


def test_a_device_is_read_and_brought_to_rest():
    check_device(LAMP, Lamp())
    with pytest.raises(DeviceBreach, match=r"it has no light.*when read it raised"):
        check_device(LAMP, object())


def test_policies_choose_among_their_options():
    for policy in every(POLICY_KIND).values():
        check_policy(policy, (TURN, BACK), situation("slip_turning"))
    stray = Policy("stray", "Elsewhere.", lambda options, s, memory: Decision(BACK))
    with pytest.raises(PolicyBreach, match="it chose back, which was no option"):
        check_policy(stray, (TURN,), situation("slip_turning"))
