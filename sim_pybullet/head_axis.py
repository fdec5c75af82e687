"""One axis of the pan-tilt unit: where its encoder says that it points, and where it truly does."""

from __future__ import annotations

from sim_pybullet.joints import Axis


class HeadAxis(Axis):
    """What its encoder cannot see is the difference between `true_rad` and `angle_rad`.

    `error_rad` is that of the last move; `bias_rad` stays. Of each motion to the positive side, against the
    pull of the harness, the share `lost_share` does not reach the head, and `play_rad` between gear and head
    is taken up first whenever it turns the other way.
    The encoder does see that the axis is `locked`, or as slow as `rate_factor` makes it.
    """

    def __init__(self, rate_rad_s: float, error_rad: float) -> None:
        super().__init__(0.0, rate_rad_s)
        self.error_rad, self.bias_rad = error_rad, 0.0
        self.lost_share, self.lost_rad = 0.0, 0.0
        self.play_rad, self._taken_up_rad = 0.0, 0.0
        self.locked, self.rate_factor = False, 1.0

    @property
    def unseen_rad(self) -> float:
        """How far the head points from where a sound one would, for the same encoder reading."""
        half_rad = self.play_rad / 2
        return self.bias_rad - self.lost_rad + min(half_rad, max(-half_rad, self._taken_up_rad))

    @property
    def true_rad(self) -> float:
        return self.angle_rad + self.error_rad + self.unseen_rad

    def advance(self, tick_s: float) -> None:
        """Turn for one tick, as far as the axis can."""
        before_rad = self.angle_rad
        if not self.locked:
            super().advance(tick_s * self.rate_factor)
        moved_rad = self.angle_rad - before_rad
        self.lost_rad += self.lost_share * max(moved_rad, 0.0)
        half_rad = self.play_rad / 2
        self._taken_up_rad = min(half_rad, max(-half_rad, self._taken_up_rad - moved_rad))
