"""What a hypothesis and an evidence channel are: frozen specs that are registered, and weighed by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

from executive.isc.comparison import Comparison
from executive.isc.likelihoods import Likelihood, Measured


class Concern(StrEnum):
    """What a hypothesis is about, which decides what the motion model learns beside it."""

    MOTION = "motion"  # the robot moved otherwise than predicted
    SIGHT = "sight"  # the robot is hard to see; beside a fix that was had it says nothing of the motion
    FIX = "fix"  # a fix is false; a second one that agrees refutes it
    REFERENCE = "reference"  # what fixes are measured from has moved; a second fix is wrong alike


@dataclass(frozen=True)
class Channel:
    """A quantity that a check may yield.

    `observe` reads it off a comparison of measurement and prediction, None where that does not show it.
    `nominal` is its likelihood when all is well; `unit` is SI, "" for a pure number or a category.
    """

    name: str
    doc: str
    unit: str
    nominal: Likelihood
    observe: Callable[[Comparison], Measured[Any] | None]


@dataclass(frozen=True)
class Hypothesis:
    """An explanation that the classification weighs.

    `signature` gives its likelihoods on the channels, by name, that it speaks about. On all others it takes
    the nominal one, so that silence neither helps nor hurts it. `prior` is its share among the anomalies.
    """

    name: str
    doc: str
    signature: Mapping[str, Likelihood] = field(hash=False)
    prior: float = 1.0
    concerns: Concern = Concern.MOTION
