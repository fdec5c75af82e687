"""The kind of localizer that a scenario can name."""

from __future__ import annotations

from collections.abc import Callable

from executive.core.ports import Localizer
from executive.core.registry import Kind

LOCALIZER_KIND: Kind[Callable[..., Localizer]] = Kind(
    "localizer",
    "localizers",
    "What finds the rover: called with devices, rig and clock.",
    Callable,  # type: ignore[arg-type]  # an abstract class, good for isinstance
    name_of=lambda localizer: None,
    scanned=False,
)
