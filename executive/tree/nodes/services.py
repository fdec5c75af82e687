"""What leaves are given: frozen, by constructor."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from executive.core.clock import Clock
from executive.core.ports import Devices, Localizer
from executive.core.rig import Rig
from executive.core.types import (
    Call,
    CameraView,
    Images,
    Outcome,
    PoseEstimate,
    Segment,
)

if TYPE_CHECKING:  # only named here, so that a tree can be read, checked and drawn without them
    from executive.isc.classification import Classification
    from executive.pool import Pool


class Journal(Protocol):
    """Where leaves put what only they know; the runner's recorder in a run, a list in a test."""

    def estimate(self, pose: PoseEstimate) -> None: ...
    def segment(self, segment: Segment | None) -> None: ...
    def waypoint(self, index: int, pose: PoseEstimate) -> Outcome[object]: ...
    def call(self, call: Call) -> None: ...
    def views(self, views: tuple[CameraView, ...], outcome: Outcome[object]) -> None: ...
    def picture(self, images: Images) -> None: ...


@dataclass(frozen=True)
class Services:
    """Ports of the robot, the localizer, the in-situ classification, the pool, and the journal."""

    clock: Clock
    devices: Devices
    rig: Rig
    localizer: Localizer
    classification: Classification
    pool: Pool
    journal: Journal
