"""How strong a fault is over the time since its onset: at once, growing, on and off, or now and then."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Self

import numpy as np
from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from executive.config.validate import Strict
from executive.core.units import Duration, Fraction, written

Positive = Annotated[Duration, Field(gt=0)]


class Intermittent(Strict):
    """On for `duty` of every `period`, the on part first."""

    period: Positive
    duty: Annotated[Fraction, Field(gt=0, lt=1)] = 0.5


class Arrivals(Strict):
    """Comes at random, a Poisson process, once in `every` on average, and lasts `lasts` each time."""

    every: Positive
    lasts: Positive


class Profile(Strict):
    """Exactly one shape; none is a step."""

    ramp: Positive | None = None
    intermittent: Intermittent | None = None
    random: Arrivals | None = None

    @model_validator(mode="after")
    def one_of_them(self) -> Self:
        if len(self.model_fields_set) != 1:
            got = ", ".join(sorted(self.model_fields_set)) or "none"
            text = f"got {got}, expected exactly one of ramp, intermittent, random, or the word step"
            raise PydanticCustomError("located", "{text}", {"text": text})
        return self


STEP = "step"


@dataclass
class Shape:
    """A profile under way. Ask `level` with times that do not decrease."""

    profile: Profile | None
    rng: np.random.Generator
    next_s: float = -1.0
    until_s: float = -math.inf

    def level(self, since_s: float) -> float:
        """Severity from 0 to 1, this long after the onset [s]."""
        if self.profile is None:
            return 1.0
        if self.profile.ramp is not None:
            return min(1.0, since_s / self.profile.ramp)
        if self.profile.intermittent is not None:
            on = self.profile.intermittent
            return 1.0 if since_s % on.period < on.duty * on.period else 0.0
        return self._arrived(self.profile.random, since_s) if self.profile.random else 1.0

    def _arrived(self, arrivals: Arrivals, since_s: float) -> float:
        if self.next_s < 0.0:
            self.next_s = float(self.rng.exponential(arrivals.every))
        while since_s >= self.next_s:
            self.until_s = self.next_s + arrivals.lasts
            self.next_s += float(self.rng.exponential(arrivals.every))
        return 1.0 if since_s < self.until_s else 0.0


def entry(profile: Profile | None) -> object:
    """The profile as a file says it."""
    if profile is None:
        return STEP
    if profile.ramp is not None:
        return {"ramp": written(profile.ramp, "s")}
    return profile.model_dump(mode="json", exclude_none=True)
