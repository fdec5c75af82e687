"""Looks now and then at ground that does not move, to notice when the head is wrong and not the rover.

A head that turns with its lander sees every fix agree with the last. What stays is the ground: before the
first fix the head takes reference pictures of it, beside the rover and near the lander, and later looks again
in the same directions. One direction will do as long as nothing seems off; what does is looked at in all.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2

from executive.core.clock import Clock
from executive.core.devices import CAMERAS, HEAD
from executive.core.ports import Devices
from executive.core.types import (
    Array,
    Centres,
    Images,
    Outcome,
    PoseEstimate,
    Reason,
    Shot,
    Vec2,
)
from perception.frames.routine import Steps, wait_for
from perception.geometry.chain import Chain
from perception.head.alignment import Alignment, align

EVERY_S = 420.0
"""Between two looks. A lander that turns by 4 degrees in an hour turns by half a degree in seven minutes,
40 mm at 5 m; a look takes some 20 s, a twentieth of that."""
LIMIT_M = 0.015
"""What a fix may be off by unsaid: half of a way-point's usual tolerance, a seventeenth of the margin."""
FALSE_ALARM = 1e-7
ASIDE_RAD = tuple(math.radians(angle) for angle in (20.0, -20.0, 35.0, -35.0))
DOWN_RAD = math.radians(35.0)  # ground 1.4 to 3.5 m off: near enough for texture, and for a shift to show
_DIRECTIONS = 2
_CLEAR_RAD = math.radians(15.0)  # half a field of view, and half a rover
_LOOK_S = 90.0  # left of a budget, it does for looking and still for a fix
_PICTURE = Shot(leds=(0,))
_SURPRISE = float(chi2.isf(1e-3, 3))
_HORIZONTAL = [0, 1, 5]  # x, y and heading in a pose's covariance


@dataclass(frozen=True, eq=False)
class Reference:
    """A picture of the ground, and where the head was sent for it."""

    head_rad: Vec2
    picture: Images | Centres


class HeadWatch:
    """Takes the reference, looks again when due, says what is wrong with the head. `note`: its last word."""

    def __init__(self, devices: Devices, chain: Chain, clock: Clock) -> None:
        self._devices, self._chain, self._clock = devices, chain, clock
        self._references: list[Reference] = []
        self._due_s = 0.0
        self.note = ""

    @property
    def due(self) -> bool:
        """Whether the last look is too long ago."""
        return self._clock.now_s >= self._due_s

    def look(self, rover: PoseEstimate, deadline_s: float) -> Steps[str | None]:
        """Look at the ground again (the first time: take the reference); what is wrong, None if nothing
        shows. `note` then says whether that means fine, or that nothing could be told."""
        if self._clock.now_s + _LOOK_S > deadline_s:
            return None
        self._due_s = self._clock.now_s + EVERY_S
        if not self._references:
            yield from self._take_references(rover, deadline_s)
            return None
        wrong = yield from self._compare(rover, deadline_s)
        if wrong is not None:
            self._due_s = self._clock.now_s  # nothing is to be believed before it is well again
        return wrong

    def _take_references(self, rover: PoseEstimate, deadline_s: float) -> Steps[None]:
        bearing = math.atan2(rover.y_m, rover.x_m)
        for aside in ASIDE_RAD:
            head_rad = (math.remainder(bearing + aside, 2 * math.pi), DOWN_RAD)
            if len(self._references) >= _DIRECTIONS or abs(head_rad[0]) > self._chain.rig.head.pan_limit_rad:
                continue
            picture = yield from self._picture(head_rad, deadline_s)
            if isinstance(picture, Outcome):
                continue
            if isinstance(align(self._chain, picture, picture), Alignment):  # else it has no texture
                self._references.append(Reference(head_rad, picture))
        self.note = f"head: {len(self._references)} reference pictures"

    def _compare(self, rover: PoseEstimate, deadline_s: float) -> Steps[str | None]:
        """One direction after the other, until one says that all is well."""
        sofar: Alignment | None = None
        why = ""
        for reference in self._in_turn(rover):
            picture = yield from self._picture(reference.head_rad, deadline_s)
            if isinstance(picture, Outcome):
                why = f"{picture.reason} {picture.detail}"
                continue
            found = align(self._chain, reference.picture, picture)
            if isinstance(found, str):
                why = found
                continue
            sofar = found if sofar is None else sofar.fuse(found)
            if not self._wrong(sofar, rover):
                self.note = f"head: fine, {sofar.as_sentence(self._bearing(rover))}"
                return None
        if sofar is None:
            self.note = f"head: unknown, {why}"
            return None
        off_m = float(np.linalg.norm(sofar.error_at(self._chain, np.array(rover.position_site_m))[0]))
        self.note = (
            f"head off by {sofar.as_sentence(self._bearing(rover))}: {off_m * 1e3:.0f} mm at the rover"
        )
        return self.note

    def _wrong(self, found: Alignment, rover: PoseEstimate) -> bool:
        """Whether fixes are off by more than may be, and that is no chance."""
        off, covariance = found.error_at(self._chain, np.array(rover.position_site_m))
        unlikely = float(off @ np.linalg.solve(covariance, off)) > chi2.isf(FALSE_ALARM, 3)
        return bool(np.linalg.norm(off) > LIMIT_M and unlikely)

    def _in_turn(self, rover: PoseEstimate) -> list[Reference]:
        """The references that the rover does not stand in, the nearest to where the head looks first."""
        now = self._devices[HEAD].read().pan_rad

        def apart(reference: Reference, pan_rad: float) -> float:
            return abs(math.remainder(reference.head_rad[0] - pan_rad, 2 * math.pi))

        free = [r for r in self._references if apart(r, self._bearing(rover)) > _CLEAR_RAD]
        return sorted(free or self._references, key=lambda r: apart(r, now))

    @staticmethod
    def _bearing(rover: PoseEstimate) -> float:
        return math.atan2(rover.y_m, rover.x_m)

    def _picture(
        self, head_rad: Vec2, deadline_s: float
    ) -> Steps[Images | Centres | Outcome[Images | Centres]]:
        """Turn there and take a picture; the failure if one of these fails."""
        turned = yield from wait_for(self._devices[HEAD].point(*head_rad), self._clock, deadline_s)
        if not turned.ok:
            return Outcome(turned.reason, turned.detail)
        taken = yield from wait_for(self._devices[CAMERAS].take(_PICTURE), self._clock, deadline_s)
        if taken.value is None or not taken.ok:
            return Outcome(taken.reason if not taken.ok else Reason.DEVICE, taken.detail)
        return taken.value


def surprising(fix: PoseEstimate, predicted: PoseEstimate) -> bool:
    """Whether a fix lies where the prediction would have it once in a thousand times."""
    turn = math.remainder(fix.heading_rad - predicted.heading_rad, 2 * math.pi)
    off: Array = np.array([fix.x_m - predicted.x_m, fix.y_m - predicted.y_m, turn])
    spread = (fix.covariance + predicted.covariance)[np.ix_(_HORIZONTAL, _HORIZONTAL)]
    return bool(off @ np.linalg.solve(spread, off) > _SURPRISE)
