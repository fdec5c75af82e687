"""Public helpers for those who write backends, strategies and trees: a fake robot and the checkers."""

from executive.testing.check_backend import check_backend
from executive.testing.check_diagnosis import check_channel, check_hypothesis
from executive.testing.check_localizer import check_localizer
from executive.testing.check_strategy import check_strategy
from executive.testing.fake import BACKEND, OVERHEAD, FakeBackend, FakeWorld, OverheadLocalizer

__all__ = [
    "BACKEND",
    "OVERHEAD",
    "FakeBackend",
    "FakeWorld",
    "OverheadLocalizer",
    "check_backend",
    "check_channel",
    "check_hypothesis",
    "check_localizer",
    "check_strategy",
]
