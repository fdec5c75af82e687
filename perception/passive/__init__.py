"""Passive features: the rover's pose from its outline against the ground that the head saw before (paper, 5)."""

from perception.passive.fix import Ground, PassiveFix, PassiveRefusal, Sun, empty_window, passive_fix

__all__ = ["Ground", "PassiveFix", "PassiveRefusal", "Sun", "empty_window", "passive_fix"]
