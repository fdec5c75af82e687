"""Synthetic surveys: what a rig that differs from the believed one sees of rover, rocks and landmarks.

Marker centres have the noise of the vision chain at their range (its Cramer-Rao bound for the pairs that it
takes, and a floor), matches of the terrain that of a correlation matcher.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from executive.core.rig import RigCalibration
from perception.calibration import Landmark, Look, PointImages, RoverImages, Station, Survey, changed_rig
from perception.frames.exposure import filter_snr_per_pair, pairs_needed, plate_view
from perception.geometry.body import Transform
from perception.geometry.chain import Chain, ChainState
from perception.geometry.follow_up import pointing_at
from perception.geometry.pose import roll_pitch
from perception.geometry.rotation import exp_map
from perception.markers.fisher import centre_bounds

FLOOR_PX = 0.02  # what no centre is better than: lens and flat field
MATCH_PX = 0.15
MATCH_OFF_PX = 40.0  # how far a mismatch may lie off
DEGREE = np.radians(1.0)
BELIEVED = RigCalibration()
LEDS_ABOVE_GROUND_M = np.array([0.0, 0.0, 0.12])


@dataclass(frozen=True)
class Field:
    """What there is to see, and how it is looked at. Places as (ground range [m], bearing [rad])."""

    stations: tuple[tuple[float, float], ...] = ((1.8, -0.3), (2.2, 0.2), (2.8, 0.0), (3.5, 0.5), (4.5, 0.2))
    aside_deg: tuple[tuple[float, float], ...] = ((0, 0), (-5, 3), (5, -3), (6, 2), (-6, -2))  # of the rover
    rocks: int = 24
    landmarks: int = 4  # so many of the rocks
    pans_deg: tuple[float, ...] = (-20.0, -13.0, -6.0, 0.0, 6.0, 13.0, 20.0)
    tilts_deg: tuple[float, ...] = (6.0, 14.0)
    warmer_k: tuple[float, ...] = (0.0,)  # than the reference, look upon look


def survey(
    values: np.ndarray, rng: np.random.Generator, field: Field | None = None, outliers: float = 0.0
) -> Survey:
    """Looks of a rig with these parameters; centres, encoders, inclinometers, joints, landmarks are noisy."""
    field = field or Field()
    world = World(values, rng, field, outliers)
    visits = [world.visit(index, *place) for index, place in enumerate(field.stations)]
    looks = [look for _, shots in visits for look in shots]
    points = world.points()
    landmarks = world.landmarks(points)
    return Survey((*looks, *world.panorama(points)), tuple(station for station, _ in visits), landmarks)


class World:
    """The true rig, looking; a share `outliers` of all images is wrong."""

    def __init__(self, values: np.ndarray, rng: np.random.Generator, field: Field, outliers: float) -> None:
        self.chain = Chain.of(changed_rig(BELIEVED, values))
        self.warm = [Chain.of(changed_rig(BELIEVED, values, warmer)) for warmer in field.warmer_k]
        self.rng, self.field, self.outliers = rng, field, outliers

    def visit(self, index: int, ground: float, bearing: float) -> tuple[Station, list[Look]]:
        """A rest of the rover, and the looks at it."""
        lean = 0.05 * self.rng.standard_normal(2)
        body = rover_body(ground, bearing, np.array([*lean, bearing + 0.3 * self.rng.standard_normal()]))
        joints = (0.0, 0.6)
        calibration = self.chain.rig.cabin
        true_joints = tuple(np.array(joints) + calibration.joint_sigma_rad * self.rng.standard_normal(2))
        tilt = roll_pitch(body.rotation)[0]
        tilt = tilt + self.chain.rig.rover.inclinometer_sigma_rad * self.rng.standard_normal(2)
        looks = []
        for number, (pan, down) in enumerate(self.field.aside_deg):
            aim = pointing_at(self.chain, body.position_m + LEDS_ABOVE_GROUND_M)
            said = (aim[0] + pan * DEGREE, aim[1] + down * DEGREE)
            chain, temperature_k = self.at(number)
            state = ChainState(body, self.pointed(said), true_joints)
            sigma = centre_sigma_px(chain, state)
            uv = self.noisy(chain.project(state)[0], sigma)
            looks.append(Look(said, RoverImages(index, uv, sigma), temperature_k=temperature_k))
        return Station(joints, (float(tilt[0]), float(tilt[1]))), looks

    def points(self) -> np.ndarray:
        count = self.field.rocks
        ground = self.rng.uniform(4.0, 16.0, count)
        bearing = np.radians(self.rng.uniform(-22, 22, count))
        return np.stack(
            [ground * np.cos(bearing), ground * np.sin(bearing), self.rng.uniform(0, 0.3, count)], axis=1
        )

    def landmarks(self, points: np.ndarray) -> dict[str, Landmark]:
        """Rocks as a sound head found them: good to 1 percent along the line of sight, 5 mm across."""
        found = {}
        for i, point in enumerate(points[: self.field.landmarks]):
            covariance = 0.005**2 * np.eye(3) + 0.01**2 * np.outer(point, point)
            error = np.linalg.cholesky(covariance) @ self.rng.standard_normal(3)
            found[f"rock {i}"] = Landmark(point + error, covariance)
        return found

    def panorama(self, points: np.ndarray) -> list[Look]:
        said = [(pan * DEGREE, down * DEGREE) for down in self.field.tilts_deg for pan in self.field.pans_deg]
        looks = [self.ground_look(number, head, points) for number, head in enumerate(said)]
        return [look for look in looks if look is not None]

    def ground_look(self, number: int, said: tuple[float, float], points: np.ndarray) -> Look | None:
        chain, temperature_k = self.at(number)
        head = chain.site_ih(self.pointed(said))
        sigma = np.full((2, len(points)), MATCH_PX)
        uv = self.noisy(chain.model.project(head.inverse().apply(points)), sigma)
        shown = np.flatnonzero(np.isfinite(uv).any(axis=(0, 2)))
        if len(shown) == 0:
            return None
        images = PointImages(tuple(f"rock {i}" for i in shown), uv[:, shown], sigma[:, shown])
        return Look(said, points=images, temperature_k=temperature_k)

    def at(self, number: int) -> tuple[Chain, float]:
        """The rig at the temperature of a look, and that temperature."""
        turn = number % len(self.warm)
        return self.warm[turn], 293.0 + self.field.warmer_k[turn]

    def pointed(self, said: tuple[float, float]) -> tuple[float, float]:
        half = np.array([self.chain.rig.head.pan_accuracy_rad, self.chain.rig.head.tilt_accuracy_rad])
        pan, tilt = np.array(said) + half * self.rng.uniform(-1, 1, 2)
        return float(pan), float(tilt)

    def noisy(self, uv: np.ndarray, sigma: np.ndarray) -> np.ndarray:
        """Noisy pixels, some of them wrong, NaN outside the frames."""
        inside = self.chain.model.inside(uv, 5.0)
        uv = uv + sigma[..., None] * self.rng.standard_normal(uv.shape)
        wrong = self.rng.uniform(size=sigma.shape) < self.outliers
        uv = np.where(wrong[..., None], uv + self.rng.uniform(-MATCH_OFF_PX, MATCH_OFF_PX, uv.shape), uv)
        return np.where(inside[..., None], uv, np.nan)


def centre_sigma_px(chain: Chain, state: ChainState) -> np.ndarray:
    """Standard deviation (2, 4) of marker centres, with the pairs that a localisation takes."""
    pairs = pairs_needed(filter_snr_per_pair(chain.rig, plate_view(chain, state)))
    covariance = centre_bounds(chain, state, pairs)
    return np.sqrt(np.einsum("cnii->cn", covariance) / 2 + FLOOR_PX**2)


def rover_body(ground_m: float, bearing_rad: float, turn_rad: np.ndarray) -> Transform:
    place = np.array([ground_m * np.cos(bearing_rad), ground_m * np.sin(bearing_rad), 0.02])
    return Transform(exp_map(turn_rad), place)


def rover_at(chain: Chain, ground_m: float, bearing_rad: float = 0.1) -> ChainState:
    """A rover at rest whose markers a rig sees in the stereoscopic middle."""
    body = rover_body(ground_m, bearing_rad, np.array([0.02, -0.03, 0.4]))
    return ChainState(body, pointing_at(chain, body.position_m + LEDS_ABOVE_GROUND_M), (0.0, 0.9))
