"""The localizer: what is asked of head and cameras, and which means answers it."""

from perception.localizer.spec import LED_STEREO

__all__ = ["LED_STEREO"]
