"""What the pool is asked with: the present situation, gathered from the services."""

from __future__ import annotations

from executive.core.devices import DRIVE
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
    services.devices[DRIVE].stop()
    pose = services.classification.predicted()
    situation = Situation(
        time_s=services.clock.now_s,
        failure=failure,
        assessment=services.classification.extrapolate(pose, segment),
        pose=pose,
        segment=segment,
        readings=_readings(services),
        doubt=services.classification.tracker.doubt,
    )
    return services.pool.choose(situation, at_hand).strategy


def _readings(services: Services) -> Readings:
    """The latest of what is read continuously, and what the other devices read now."""
    now = {
        fitted.spec.name: fitted.spec.read(fitted.device)
        for fitted in services.devices
        if fitted.spec.quantities and not fitted.spec.sensed
    }
    return Readings({**services.classification.tracker.readings.by_device, **now})
