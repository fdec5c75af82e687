"""Point the imaging head, and take a picture for the record."""

from __future__ import annotations

from typing import Any

from executive.core.devices import CAMERAS, HEAD
from executive.core.ports import Action
from executive.core.types import (
    HeadReading,
    Images,
    Outcome,
    PoseEstimate,
    Reason,
    Shot,
)
from executive.core.values import POSE
from executive.tree.nodes.action import ActionLeaf
from executive.tree.nodes.base import In


class PointHead(ActionLeaf):
    """Turn the head so that `pose` lies in the middle of the stereoscopic overlap."""

    needs = ("head",)

    pose = In[PoseEstimate](POSE, "what to look at")

    outcomes = (Reason.DONE, Reason.OUT_OF_REACH, Reason.DEVICE)

    def request(self) -> Action[HeadReading]:
        pan, tilt = self.services.localizer.pointing(self.pose)
        return self.services.devices[HEAD].point(pan, tilt)


class TakePicture(ActionLeaf):
    """Take one full stereo frame for the record. A tier without images has nothing to keep."""

    needs = ("cameras",)
    outcomes = (Reason.DONE, Reason.DEVICE)

    def request(self) -> Action[Any]:
        return self.services.devices[CAMERAS].take(Shot(leds=(0b1111,)))

    def finish(self, outcome: Outcome[Any]) -> Outcome[Any]:
        if isinstance(outcome.value, Images):
            self.services.journal.picture(outcome.value)
        return Outcome(outcome.reason, outcome.detail)
