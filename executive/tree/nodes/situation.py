"""What the pool is asked with: the present situation, gathered from the services."""

from __future__ import annotations

from executive.core.types import Outcome, Segment
from executive.isc.readings import Readings
from executive.pool.situation import Situation
from executive.tree.nodes.services import Services


def conclude(services: Services, segment: Segment | None, helped: bool) -> None:
    """Tell the pool what came of the strategy chosen last, and how far along the rover is by now."""
    track = services.classification.predicted().on(segment).track
    services.pool.conclude(helped, track.along_m if track else None)


def choose(
    services: Services, segment: Segment | None, failure: Outcome[object], at_hand: frozenset[str]
) -> str | None:
    """The strategy that the pool chooses among those at hand, None to call home. The rover rests."""
    services.devices.tracks.stop()
    pose = services.classification.predicted()
    situation = Situation(
        time_s=services.clock.now_s,
        failure=failure,
        assessment=services.classification.extrapolate(pose, segment),
        pose=pose,
        segment=segment,
        readings=_readings(services),
    )
    return services.pool.choose(situation, at_hand).strategy


def _readings(services: Services) -> Readings:
    """The latest of what is read continuously, and of the cabin."""
    sensed = services.classification.tracker.readings.by_device
    return Readings({**sensed, "cabin": services.devices.cabin.read()})
