"""The localizer: what is asked of head and cameras, and which means answers it."""

from perception.localizer.localizer import LedStereoLocalizer

__all__ = ["LedStereoLocalizer"]
