"""Public helpers for those who write plug-ins: a fake robot, a bench to tick on, and the checkers."""

from executive.testing.bench import Bench, Ended
from executive.testing.check_backend import BackendBreach, check_backend
from executive.testing.check_declared import (
    DeviceBreach,
    NodeBreach,
    PolicyBreach,
    check_device,
    check_node,
    check_policy,
)
from executive.testing.check_diagnosis import check_channel, check_hypothesis
from executive.testing.check_fault import FaultBreach, check_fault
from executive.testing.check_leaf import LeafBreach, check_leaf
from executive.testing.check_localizer import LocalizerBreach, check_localizer
from executive.testing.check_strategy import StrategyBreach, check_strategy
from executive.testing.fake import BACKEND, OVERHEAD, FakeBackend, FakeWorld, OverheadLocalizer, fake_with

__all__ = [
    "BACKEND",
    "OVERHEAD",
    "BackendBreach",
    "Bench",
    "DeviceBreach",
    "Ended",
    "FakeBackend",
    "FakeWorld",
    "FaultBreach",
    "LeafBreach",
    "LocalizerBreach",
    "NodeBreach",
    "OverheadLocalizer",
    "PolicyBreach",
    "StrategyBreach",
    "check_backend",
    "check_channel",
    "check_device",
    "check_fault",
    "check_hypothesis",
    "check_leaf",
    "check_localizer",
    "check_node",
    "check_policy",
    "check_strategy",
    "fake_with",
]
