"""What is asked of a robot. A backend (hardware, simulation, fake) answers; nobody else does.

Everything that takes time returns an `Action`: poll it once a tick, cancel it when no longer wanted.
A device that cannot do what was asked ends its action with the physical reason; it does not raise.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Protocol, TypeVar

from executive.core.clock import Clock
from executive.core.device_spec import DeviceSpec, Fitted
from executive.core.rig import Rig
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

T = TypeVar("T")
T_co = TypeVar("T_co", covariant=True)


class Action(Protocol[T_co]):
    """Something under way."""

    def poll(self) -> Outcome[T_co] | None:
        """The outcome, or None while under way. Once given, the outcome stays the same."""
        ...

    def cancel(self) -> None:
        """Stop it now; the next poll says CANCELLED. Without effect once ended."""
        ...


class Drive(Protocol):
    """Two tracks or rows of wheels, driven by travel as their encoders count it; "belts" stands for both."""

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


class MissingDevice(LookupError):
    """A device was asked for that this robot does not have; the message says which ones it has."""


class Devices:
    """What a robot has: frozen, by name, and typed by spec: `devices[DRIVE].stop()`, `devices.get(TETHER)`.

    A device that serves as another is found under both names. ValueError where two share a name.
    """

    def __init__(self, *fitted: Fitted) -> None:
        """`Devices(TRACKS.fit(tracks), CAMERAS.fit(cameras))`."""
        self._fitted: dict[str, Fitted] = {one.spec.name: one for one in fitted}
        self._by_name: dict[str, Fitted] = {}
        for one in fitted:
            for name in one.spec.names:
                if (other := self._by_name.setdefault(name, one)) is not one:
                    raise ValueError(f"{other.spec.name} and {one.spec.name} both answer to {name!r}")

    def __getitem__(self, spec: DeviceSpec[T]) -> T:
        """The device; MissingDevice if this robot has none."""
        one = self._by_name.get(spec.name)
        if one is None:
            has = ", ".join(sorted(self._fitted)) or "none"
            raise MissingDevice(f"there is no device {spec.name!r} on this robot; it has {has}")
        device: T = one.device
        return device

    def get(self, spec: DeviceSpec[T]) -> T | None:
        """The device, None if this robot has none."""
        return self[spec] if spec.name in self._by_name else None

    @property
    def names(self) -> frozenset[str]:
        """Every name that a device answers to."""
        return frozenset(self._by_name)

    def named(self, name: str) -> object:
        """The device of this name; KeyError if there is none."""
        return self._by_name[name].device

    def __iter__(self) -> Iterator[Fitted]:
        return iter(self._fitted.values())

    def replace(self, spec: DeviceSpec[T], device: T) -> Devices:
        """The same devices, this one in place of what answers to `spec`; MissingDevice if nothing does."""
        self[spec]
        there = self._by_name[spec.name]
        return Devices(*(one.spec.fit(device) if one is there else one for one in self))


class Backend(Protocol):
    """A robot, real or not, and the only thing that lets its time pass."""

    devices: Devices
    clock: Clock

    @property
    def rig(self) -> Rig:
        """What it is built like, as the executive knows it."""
        ...

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
