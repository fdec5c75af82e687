"""What markers give: a fix, or why there is none."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from executive.core.types import Array
from perception.geometry.chain import Chain
from perception.geometry.pose import PoseFit

Result = TypeVar("Result", bound="MarkerFix | Rejection")


@dataclass(frozen=True, eq=False)
class MarkerFix:
    """A pose that the markers give, each seen by itself or all as one; `note` says what is odd about it.

    `detected_px` (2, n, 2) are the centres that it rests on, NaN where none. Of markers too faint to be seen
    singly they are where the images pull each.
    """

    fit: PoseFit
    detected_px: Array
    note: str = ""

    @property
    def shining(self) -> tuple[int, ...]:
        """The markers that entered the pose."""
        seen = np.isfinite(self.detected_px).all(axis=-1).any(axis=0)
        return tuple(np.flatnonzero(seen).tolist())

    @property
    def markers(self) -> int:
        """How many these are."""
        return len(self.shining)


@dataclass(frozen=True)
class Rejection:
    """Why there is no fix. `seen` counts LEDs with a candidate in every camera that sees."""

    why: str
    seen: int


def with_note(result: Result, note: str) -> Result:
    """The result with a note put before what it says, if there is one."""
    if not note:
        return result
    if isinstance(result, Rejection):
        return replace(result, why=f"{note}; {result.why}")
    return replace(result, note="; ".join(filter(None, (note, result.note))))


def faces_cameras(chain: Chain, fit: PoseFit) -> bool:
    """Whether the marker plane shows its lit side to the head: a mirrored assignment shows its back."""
    plc = chain.site_plc(fit.state)
    mast = np.array([0.0, 0.0, chain.rig.head.mast_height_m])
    return bool(plc.rotation[:, 2] @ (mast - plc.position_m) > 0)
