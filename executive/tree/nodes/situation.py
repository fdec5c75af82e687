"""What the pool is asked with: the present situation, gathered from the services."""

from __future__ import annotations

from executive.core.devices import CABIN, DRIVE
from executive.core.types import Outcome, Segment
from executive.pool.pool import Situation
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
    cabin = services.devices.get(CABIN)
    pose = services.classification.predicted()
    situation = Situation(
        time_s=services.clock.now_s,
        failure=failure,
        assessment=services.classification.assess(pose, segment),
        pose=pose,
        segment=segment,
        cabin=None if cabin is None else cabin.read(),
    )
    services.journal.assessment(situation.assessment)
    return services.pool.choose(situation, at_hand).strategy
