"""What trees of this robot can ask and do about its battery."""

from __future__ import annotations

from longarm import DURATION, NUMBER, In, Leaf, Outcome, Reason

from yard_robot.devices import BATTERY

_SINKING_S = 300.0  # a battery that has sunk for so long at rest is not going to be charged


class CheckBattery(Leaf):
    """Is the battery charged by `least` or more? A no is evidence for the classification."""

    least = In[float](NUMBER, "state of charge that it must have, 0 to 1", default=0.3)

    needs = ("battery",)
    outcomes = (Reason.DONE, Reason.DEVICE)

    def step(self) -> Outcome[object]:
        charge = self.services.devices[BATTERY].read().charge
        if charge >= self.least:
            return Outcome(Reason.DONE, f"{charge:.0%}")
        outcome: Outcome[object] = Outcome(Reason.DEVICE, f"battery at {charge:.0%}, needs {self.least:.0%}")
        self.services.classification.on_failure(outcome)
        return outcome


class RechargeWait(Leaf):
    """Wait at rest until the battery is charged to `until`; fails when it sinks for minutes."""

    until = In[float](NUMBER, "state of charge to wait for, 0 to 1", default=0.5)
    patience = In[float](DURATION, "the longest wait", default=3600.0)

    needs = ("drive", "battery")
    outcomes = (Reason.DONE, Reason.DEVICE, Reason.TIMEOUT)

    def begin(self) -> None:
        clock = self.services.clock
        self._give_up_s = clock.now_s + self.patience
        self._lowest, self._lowest_s = 1.0, clock.now_s

    def step(self) -> Outcome[object] | None:
        now_s, charge = self.services.clock.now_s, self.services.devices[BATTERY].read().charge
        if charge >= self.until:
            return Outcome(Reason.DONE, f"{charge:.0%}")
        if charge > self._lowest:
            self._lowest_s = now_s
        self._lowest = min(self._lowest, charge)
        if now_s >= self._give_up_s:
            return Outcome(Reason.TIMEOUT, f"{charge:.0%} after {self.patience:.0f} s")
        if now_s - self._lowest_s > _SINKING_S:
            return Outcome(Reason.DEVICE, f"still sinking, {charge:.0%}")
        return None
