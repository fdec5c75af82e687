"""What is asked of a robot. A backend (hardware, simulation, fake) answers; nobody else does.

Everything that takes time returns an `Action`: poll it once a tick, cancel it when no longer wanted.
A device that cannot do what was asked ends its action with the physical reason; it does not raise.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol, TypeVar

from executive.core.clock import Clock
from executive.core.rig import RigCalibration
from executive.core.types import (
    CabinReading,
    Call,
    Centres,
    HeadReading,
    Images,
    Localisation,
    Outcome,
    PoseEstimate,
    Quality,
    Segment,
    Shot,
    TetherReading,
    TiltReading,
    TrackReading,
    Vec2,
)

T_co = TypeVar("T_co", covariant=True)


class Action(Protocol[T_co]):
    """Something under way."""

    def poll(self) -> Outcome[T_co] | None:
        """The outcome, or None while under way. Once given, the outcome stays the same."""
        ...

    def cancel(self) -> None:
        """Stop it now; the next poll says CANCELLED. Without effect once ended."""
        ...


class Tracks(Protocol):
    """The two tracks, driven by belt travel as their encoders count it."""

    def drive(self, left_m: float, right_m: float, speed_m_s: float) -> Action[TrackReading]:
        """Move the belts by these travels, both ending together; the faster one at `speed_m_s`.

        Replaces a drive under way (which ends CANCELLED). Ends DONE at the travels, BLOCKED on overcurrent.
        """
        ...

    def stop(self) -> None:
        """Stop both belts at once."""
        ...

    def read(self) -> TrackReading: ...


class Cabin(Protocol):
    """The payload cabin on its arm and cabin joints."""

    def move(self, arm_rad: float, cabin_rad: float) -> Action[CabinReading]:
        """Move both joints; OUT_OF_REACH outside their limits, at once and without moving."""
        ...

    def read(self) -> CabinReading: ...


class Head(Protocol):
    """The pan-tilt unit under the stereo pair."""

    def point(self, pan_rad: float, tilt_rad: float) -> Action[HeadReading]:
        """Turn to these angles; OUT_OF_REACH outside its limits, at once and without moving."""
        ...

    def read(self) -> HeadReading: ...


class Cameras(Protocol):
    """The stereo pair and the LED sequencer, triggered together."""

    def take(self, shot: Shot) -> Action[Images | Centres]:
        """Expose the sequence. The geometric tier answers with marker centres instead of images."""
        ...


class Inclinometer(Protocol):
    def read(self) -> TiltReading: ...


class Tether(Protocol):
    def read(self) -> TetherReading: ...


class Link(Protocol):
    """The link to ground, 20 minutes each way."""

    def call(self, call: Call) -> Action[str]:
        """Send; ends DONE with ground's answer, TIMEOUT if none comes."""
        ...


@dataclass(frozen=True)
class Devices:
    """Every port of the robot. Fault wrappers replace fields of it."""

    tracks: Tracks
    cabin: Cabin
    head: Head
    cameras: Cameras
    inclinometer: Inclinometer
    tether: Tether
    link: Link


class Backend(Protocol):
    """A robot, real or not, and the only thing that lets its time pass."""

    devices: Devices
    clock: Clock
    rig: RigCalibration

    def advance(self) -> None:
        """Let one tick of mission time pass."""
        ...

    def safe_stop(self) -> None:
        """Bring the rover to rest whatever is under way; must not raise, may be called twice."""
        ...

    def wall_s(self) -> Mapping[str, float]:
        """Wall time spent so far by part (`physics`, `render`) [s]; empty if not measured."""
        ...

    def close(self) -> None:
        """Release everything; may be called twice."""
        ...


@dataclass(frozen=True)
class LocaliseRequest:
    """A localisation asked for: its quality, where to look, how long it may take, and where the way leads.

    Standard deviations that it names [m, rad] replace those of the quality; 0 names none. ValueError below 0.
    """

    quality: Quality
    predicted: PoseEstimate
    budget_s: float = 600.0
    segment: Segment | None = None
    position_sigma_m: float = 0.0
    heading_sigma_rad: float = 0.0

    def __post_init__(self) -> None:
        for name in ("position_sigma_m", "heading_sigma_rad"):
            if not getattr(self, name) >= 0:
                raise ValueError(f"{name}: got {getattr(self, name)}, expected 0 or more")


class Localizer(Protocol):
    """Finds the rover with head and cameras, and says where the head should look."""

    def locate(self, request: LocaliseRequest) -> Action[Localisation]:
        """Measure. Ends DONE with a pose, or with a reason that the classification can use: no guess.

        A failure carries what was looked at all the same, and a pose that was measured but not believed.
        """
        ...

    def pointing(self, pose: PoseEstimate) -> Vec2:
        """Pan and tilt [rad] that put this pose in the middle of the stereoscopic overlap."""
        ...
