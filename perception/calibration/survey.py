"""What a rig is calibrated from: looks of the head at the rover's markers and at points of the terrain."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from executive.core.types import Array, Centres, Vec2
from perception.geometry.checks import as_array, as_finite

NEAREST_M, FARTHEST_M = 0.3, 1000.0


@dataclass(frozen=True, eq=False)
class RoverImages:
    """The rover's markers in one look, while it rested at `station`.

    `uv_px` (2 cameras, n markers, 2), NaN where not seen; `sigma_px` (2, n), standard deviation of each axis.
    """

    station: int
    uv_px: Array
    sigma_px: Array


@dataclass(frozen=True, eq=False)
class PointImages:
    """Terrain points or marks on the lander in one look, matched to those of other looks by their names.

    `uv_px` (2, n, 2), NaN where a camera does not see the point; `sigma_px` (2, n).
    """

    names: tuple[str, ...]
    uv_px: Array
    sigma_px: Array


@dataclass(frozen=True, eq=False)
class Look:
    """One pointing of the head (pan, tilt as the encoders read), what it showed, how warm the head was."""

    head_rad: Vec2
    rover: RoverImages | None = None
    points: PointImages | None = None
    temperature_k: float = 293.0

    @classmethod
    def at_rover(cls, centres: Centres, station: int, temperature_k: float = 293.0) -> Look:
        """A look made of marker centres as the cameras' port gives them."""
        head = (centres.head.pan_rad, centres.head.tilt_rad)
        return cls(head, RoverImages(station, centres.uv_px, centres.sigma_px), temperature_k=temperature_k)


@dataclass(frozen=True)
class Station:
    """A rest of the rover: its cabin joints (arm, cabin) and inclinometers (roll, pitch), as read."""

    joints_rad: Vec2
    tilt_rad: Vec2


@dataclass(frozen=True, eq=False)
class Landmark:
    """A point whose place in `site` is known: a mark on the lander, or a rock surveyed at landing.

    `position_site_m` (3,); `covariance` (3, 3) [m2].
    """

    position_site_m: Array
    covariance: Array


@dataclass(frozen=True, eq=False)
class Survey:
    """All looks, the stations they refer to by index, and landmarks by the name of their point."""

    looks: tuple[Look, ...]
    stations: tuple[Station, ...] = ()
    landmarks: Mapping[str, Landmark] = field(default_factory=dict)

    def checked(self, markers: int) -> Survey:
        """This survey; ValueError saying what is wrong with it for a rig of so many markers."""
        if not self.looks:
            raise ValueError("looks: got none, expected one or more")
        for index, look in enumerate(self.looks):
            self._check_look(f"looks[{index}]", look, markers)
        for index, station in enumerate(self.stations):
            as_finite(f"stations[{index}].joints_rad", station.joints_rad, (2,))
            as_finite(f"stations[{index}].tilt_rad", station.tilt_rad, (2,))
        for name, landmark in self.landmarks.items():
            as_finite(f"landmarks[{name}].position_site_m", landmark.position_site_m, (3,))
            covariance = as_finite(f"landmarks[{name}].covariance", landmark.covariance, (3, 3))
            if np.linalg.eigvalsh(covariance).min() <= 0 or not np.allclose(covariance, covariance.T):
                raise ValueError(f"landmarks[{name}].covariance: expected symmetric and positive definite")
        return self

    def _check_look(self, at: str, look: Look, markers: int) -> None:
        as_finite(f"{at}.head_rad", look.head_rad, (2,))
        if not np.isfinite(look.temperature_k):
            raise ValueError(f"{at}.temperature_k: got {look.temperature_k}, expected a number")
        if look.rover is not None:
            if not 0 <= look.rover.station < len(self.stations):
                raise ValueError(f"{at}: got station {look.rover.station} of {len(self.stations)}")
            _check_images(f"{at}.rover", look.rover.uv_px, look.rover.sigma_px, markers)
        if look.points is not None:
            if len(set(look.points.names)) != len(look.points.names):
                raise ValueError(f"{at}.points.names: got a name twice, expected each once")
            _check_images(f"{at}.points", look.points.uv_px, look.points.sigma_px, len(look.points.names))


def _check_images(at: str, uv_px: Array, sigma_px: Array, count: int) -> None:
    uv = as_array(f"{at}.uv_px", uv_px, (2, count, 2))
    sigma = as_array(f"{at}.sigma_px", sigma_px, (2, count))
    seen = np.isfinite(uv).all(axis=-1)
    if not (np.isfinite(sigma[seen]).all() and (sigma[seen] > 0).all()):
        raise ValueError(f"{at}.sigma_px: expected positive numbers wherever a point is seen")
