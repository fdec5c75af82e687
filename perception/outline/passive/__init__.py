"""Passive features (paper, 5): the rover's pose from its outline against the ground seen before."""

from perception.outline.passive.fix import empty_window, passive_fix
from perception.outline.passive.judging import (
    Ground,
    PassiveFix,
    PassiveRefusal,
    Sun,
)

__all__ = ["Ground", "PassiveFix", "PassiveRefusal", "Sun", "empty_window", "passive_fix"]
