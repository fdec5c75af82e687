"""What control nodes, devices and policies must keep: what they declare, and in use where it can be tried."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TypeVar

from executive.core.device_spec import DEVICE_KIND, DeviceSpec
from executive.core.errors import Breach
from executive.pool import Decision, Memory, Option, Policy, Situation, Strategy
from executive.pool.known import broken_by_policy
from executive.testing.bench import Bench
from executive.tree.nodes.control import Children, ControlNode
from executive.tree.nodes.kind import broken_promises_of_control
from executive.tree.ports import REQUIRED

T = TypeVar("T")


class NodeBreach(Breach):
    """The control node breaks promises; the message says which."""


class DeviceBreach(Breach):
    """The device breaks promises; the message says which."""


class PolicyBreach(Breach):
    """The policy breaks promises; the message says which."""


def check_node(node: type[ControlNode]) -> None:
    """Raise NodeBreach with every promise not kept; one without required ports is ticked over waits too."""
    broken = list(broken_promises_of_control(node))
    if not broken and all(port.default is not REQUIRED for port in node.ports()):
        broken += _ticked(node)
    if broken:
        raise NodeBreach(f"control node {node.name}", broken)


def check_device(spec: DeviceSpec[T], device: T | None = None) -> None:
    """Raise DeviceBreach with every promise not kept; a `device` given is read and brought to rest too."""
    broken = list(DEVICE_KIND.faults_of(spec.name, spec))
    if not broken and device is not None:
        broken += _in_use(spec, device)
    if broken:
        raise DeviceBreach(f"device {spec.name}", broken)


def check_policy(policy: Policy, strategies: tuple[Strategy, ...], situation: Situation) -> None:
    """Raise PolicyBreach with every promise not kept, and with what it decides wrongly among `strategies`."""
    broken = list(broken_by_policy(policy))
    if not broken:
        broken += _decided(policy, strategies, situation)
    if broken:
        raise PolicyBreach(f"policy {policy.name}", broken)


def _ticked(node: type[ControlNode]) -> Iterator[str]:
    count = {Children.ONE: 1, Children.TWO: 2, Children.MANY: 2}[node.children]
    waits = [f"{{wait: {{duration: {seconds} s}}}}" for seconds in range(1, count + 1)]
    root = f"{node.name}: [{', '.join(waits)}]" if count > 1 else f"{node.name}: {{child: {waits[0]}}}"
    try:
        Bench(own=[node]).run_tree(root)
    except Exception as error:  # whatever a plug-in raises is its defect
        yield f"over waits it raised {type(error).__name__}: {error}"


def _in_use(spec: DeviceSpec[T], device: T) -> Iterator[str]:
    yield from (
        f"it has no {verb.name}" for verb in spec.verbs if not callable(getattr(device, verb.name, 0))
    )
    for what, use in (("read", spec.sample), ("brought to rest", spec.rest)):
        try:
            if use is not None:
                use(device)
        except Exception as error:  # the same
            yield f"when {what} it raised {type(error).__name__}: {error}"


def _decided(policy: Policy, strategies: tuple[Strategy, ...], situation: Situation) -> Iterator[str]:
    options = [Option(strategy, 1.0 / (1 + rank)) for rank, strategy in enumerate(strategies)]
    try:
        decision: object = policy.choose(options, situation, Memory())
    except Exception as error:  # the same
        yield f"it raised {type(error).__name__}: {error}"
        return
    if not isinstance(decision, Decision):
        yield f"it gave {decision!r}, expected a Decision"
    elif decision.strategy is not None and decision.strategy not in strategies:
        yield f"it chose {decision.strategy.name}, which was no option"
