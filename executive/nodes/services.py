"""What leaves are given: frozen, by constructor."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from executive.classification import Classification
from executive.pool import Pool

from executive.clock import Clock
from executive.ports import Devices, Localizer
from executive.rig import RigCalibration
from executive.types import Call, Outcome, PoseEstimate, Segment


class Journal(Protocol):
    """Where leaves put what only they know; the runner's recorder in a run, a list in a test."""

    def estimate(self, pose: PoseEstimate) -> None: ...
    def segment(self, segment: Segment | None) -> None: ...
    def waypoint(self, index: int, pose: PoseEstimate) -> None: ...
    def call(self, call: Call) -> None: ...
    def end(self, outcome: Outcome[object]) -> None: ...


@dataclass(frozen=True)
class Services:
    """Ports of the robot, the localizer, the in-situ classification, the pool, and the journal."""

    clock: Clock
    devices: Devices
    rig: RigCalibration
    localizer: Localizer
    classification: Classification
    pool: Pool
    journal: Journal
