"""Belts that move though no drive is commanded: a relay that sticks, a motor that does not stop."""

from __future__ import annotations

from dataclasses import dataclass

from executive.core.ports import Action, Drive
from executive.core.types import TrackReading

LEAST_M = 0.005
"""What a belt may count at rest: more than its counters jitter, less than harms; four seconds of driving."""

AGAIN_M = 0.030
"""What it may go on by before that is told anew: what answers the first alarm must get to wait it out."""


@dataclass
class RestingDrive:
    """A drive that knows whether a drive is commanded. Ask `astray` once a tick."""

    inner: Drive
    _drive: Action[TrackReading] | None = None
    _rest_m: tuple[float, float] | None = None
    _allowed_m: float = LEAST_M

    def drive(self, left_m: float, right_m: float, speed_m_s: float) -> Action[TrackReading]:
        self._drive = self.inner.drive(left_m, right_m, speed_m_s)
        self._rest_m, self._allowed_m = None, LEAST_M
        return self._drive

    def stop(self) -> None:
        self.inner.stop()
        self._drive = None

    def read(self) -> TrackReading:
        return self.inner.read()

    def astray(self, now: TrackReading) -> str | None:
        """What moves uncommanded, None if nothing does. It is stopped again, and told anew if it goes on."""
        if self._drive is not None and self._drive.poll() is None:
            return None
        self._drive = None
        counted_m = (now.left_m, now.right_m)
        rest_m = self._rest_m
        if rest_m is None:
            self._rest_m = counted_m
            return None
        left_m, right_m = (counted - rest for counted, rest in zip(counted_m, rest_m, strict=True))
        if not max(abs(left_m), abs(right_m)) > self._allowed_m:
            return None
        self.inner.stop()
        self._rest_m, self._allowed_m = counted_m, AGAIN_M
        side, far_m = ("left", left_m) if abs(left_m) >= abs(right_m) else ("right", right_m)
        return f"the {side} belt moved by {far_m * 1e3:.0f} mm without a command"
