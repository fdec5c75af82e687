"""A survey as flat arrays: which target each look shows, and where in both images."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from executive.core.types import Array
from perception.calibration.survey import Survey

Indices = NDArray[np.intp]
Mask = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class TargetImages:
    """N pairs of look and target; targets are the markers at station 0, 1, ..., then the named points.

    `look` and `target` (N,); `uv_px` (2, N, 2); `sigma_px` (2, N); `seen` (2, N): the images that count.
    """

    look: Indices
    target: Indices
    uv_px: Array
    sigma_px: Array
    seen: Mask
    names: tuple[str, ...]

    @classmethod
    def of(cls, survey: Survey, markers: int) -> TargetImages:
        """All images; a point of unknown place that only one image shows says nothing and is left out."""
        names = tuple(sorted({name for look in survey.looks if look.points for name in look.points.names}))
        number = {name: len(survey.stations) * markers + i for i, name in enumerate(names)}
        look: list[int] = []
        target: list[int] = []
        uv, sigma = [], []
        for index, shown in enumerate(survey.looks):
            if shown.rover is not None:
                first = shown.rover.station * markers
                look += [index] * markers
                target += range(first, first + markers)
                uv.append(shown.rover.uv_px)
                sigma.append(shown.rover.sigma_px)
            if shown.points is not None:
                look += [index] * len(shown.points.names)
                target += [number[name] for name in shown.points.names]
                uv.append(shown.points.uv_px)
                sigma.append(shown.points.sigma_px)
        if not uv:
            raise ValueError("looks: got none that shows rover or points, expected one or more")
        uv_px = np.concatenate(uv, axis=1, dtype=np.float64)
        sigma_px = np.concatenate(sigma, axis=1, dtype=np.float64)
        seen = np.asarray(np.isfinite(uv_px).all(axis=-1))
        every = cls(np.array(look), np.array(target), uv_px, sigma_px, seen, names)
        return every._without_lone_points(survey, markers)

    def _without_lone_points(self, survey: Survey, markers: int) -> TargetImages:
        known = len(survey.stations) * markers
        lone = self.images_of_targets() < 2
        lone[:known] = False
        for i, name in enumerate(self.names):
            lone[known + i] &= name not in survey.landmarks
        return self.only(~lone[self.target])

    def only(self, counts: Mask) -> TargetImages:
        """The same with images (2, N) or pairs (N,) that do not count any more."""
        seen = np.asarray(self.seen & counts)
        return TargetImages(self.look, self.target, self.uv_px, self.sigma_px, seen, self.names)

    def images_of_targets(self) -> Indices:
        """How many images count for each target."""
        least = int(self.target.max()) + 1
        return np.bincount(self.target, weights=self.seen.sum(axis=0), minlength=least).astype(np.intp)
