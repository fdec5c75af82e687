"""Synthetic surveys: what a rig that differs from the believed one sees of rover, rocks and landmarks.

Marker centres have the noise of the vision chain at their range (its Cramer-Rao bound for the pairs that it
takes, and a floor), matches of the terrain that of a correlation matcher.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from executive.rig import RigCalibration
from perception.body import Transform
from perception.calibration import Landmark, Look, PointImages, RoverImages, Station, Survey
from perception.chain import Chain, ChainState
from perception.exposure import filter_snr_per_pair, pairs_needed, view_of
from perception.fisher import centre_bounds
from perception.follow_up import pointing_at
from perception.pose import roll_pitch
from perception.rotation import exp_map

FLOOR_PX = 0.02  # what no centre is better than, lens and flat field
MATCH_PX = 0.15
MATCH_OFF_PX = 40.0  # how far a mismatch may lie off
DEGREE = np.radians(1.0)
BELIEVED = RigCalibration()


@dataclass(frozen=True)
class Field:
    """What there is to see, as (ground range [m], bearing [rad])."""

    stations: tuple[tuple[float, float], ...] = ((1.8, -0.3), (2.2, 0.2), (2.8, 0.0), (3.5, 0.5), (4.5, 0.2))
    rover_offsets: tuple[tuple[float, float], ...] = ((0, 0), (3, -5), (-3, 5), (2, 6), (-2, -6))  # degrees
    rocks: int = 24
    landmarks: int = 4
    pans: tuple[float, ...] = (-20.0, -13.0, -6.0, 0.0, 6.0, 13.0, 20.0)  # degrees
    tilts: tuple[float, ...] = (6.0, 14.0)


def survey(
    true: RigCalibration, rng: np.random.Generator, field: Field | None = None, outliers: float = 0.0
) -> Survey:
    """Looks of the true rig, with noise of centres, encoders, inclinometers, joints and landmarks."""
    field = field or Field()
    world = World(true, rng, outliers)
    stations, looks = [], []
    for index, (ground, bearing) in enumerate(field.stations):
        station, shots = world.rover(index, ground, bearing, field.rover_offsets)
        stations.append(station)
        looks += shots
    points = world.points(field)
    landmarks = world.surveyed(points, field.landmarks)
    looks += world.terrain(points, field)
    return Survey(tuple(looks), tuple(stations), landmarks)


class World:
    """The true rig, looking."""

    def __init__(self, true: RigCalibration, rng: np.random.Generator, outliers: float) -> None:
        self.chain, self.rng, self.outliers = Chain.of(true), rng, outliers
        self.believed = Chain.of(BELIEVED)

    def rover(self, index, ground, bearing, offsets):
        joints = (0.0, 0.6)
        turn = np.array([*(0.05 * self.rng.standard_normal(2)), bearing + 0.3 * self.rng.standard_normal()])
        place = np.array([ground * np.cos(bearing), ground * np.sin(bearing), 0.02])
        body = Transform(exp_map(turn), place)
        aim = pointing_at(self.chain, place + [0, 0, 0.12])
        rig = self.chain.rig
        sigma = rig.rover.inclinometer_sigma_rad
        said_tilt = roll_pitch(body.rotation)[0] + sigma * self.rng.standard_normal(2)
        true_joints = tuple(np.array(joints) + rig.cabin.joint_sigma_rad * self.rng.standard_normal(2))
        looks = []
        for tilt, pan in offsets:
            said = (aim[0] + pan * DEGREE, aim[1] + tilt * DEGREE)
            state = ChainState(body, self.head(said), true_joints)
            uv, _ = self.chain.project(state)
            covariance = centre_bounds(self.chain, state, self.pairs(state))
            noise = np.sqrt(np.einsum("cnii->cn", covariance) / 2 + FLOOR_PX**2)
            uv = self.seen(uv, noise)
            looks.append(Look(said, RoverImages(index, uv, noise)))
        return Station(joints, (float(said_tilt[0]), float(said_tilt[1]))), looks

    def pairs(self, state) -> float:
        return pairs_needed(filter_snr_per_pair(self.chain.rig, view_of(self.chain, state)))

    def points(self, field: Field) -> np.ndarray:
        ground = self.rng.uniform(4.0, 16.0, field.rocks)
        bearing = np.radians(self.rng.uniform(-22, 22, field.rocks))
        height = self.rng.uniform(0.0, 0.3, field.rocks)
        return np.stack([ground * np.cos(bearing), ground * np.sin(bearing), height], axis=1)

    def surveyed(self, points: np.ndarray, count: int) -> dict[str, Landmark]:
        """Landmarks as the head found them when it was sound: 1 percent along, 5 mm across."""
        found = {}
        for i in range(count):
            along = points[i] / np.linalg.norm(points[i])
            covariance = 0.005**2 * np.eye(3) + (0.01 * np.linalg.norm(points[i])) ** 2 * np.outer(
                along, along
            )
            error = np.linalg.cholesky(covariance) @ self.rng.standard_normal(3)
            found[f"rock {i}"] = Landmark(points[i] + error, covariance)
        return found

    def terrain(self, points: np.ndarray, field: Field) -> list[Look]:
        looks = []
        for tilt in field.tilts:
            for pan in field.pans:
                said = (pan * DEGREE, tilt * DEGREE)
                head = self.chain.site_ih(self.head(said))
                sigma = np.full((2, len(points)), MATCH_PX)
                uv = self.seen(self.chain.model.project(head.inverse().apply(points)), sigma)
                shown = np.flatnonzero(np.isfinite(uv).any(axis=(0, 2)))
                if len(shown):
                    names = tuple(f"rock {i}" for i in shown)
                    looks.append(Look(said, points=PointImages(names, uv[:, shown], sigma[:, shown])))
        return looks

    def head(self, said):
        half = np.array([self.chain.rig.head.pan_accuracy_rad, self.chain.rig.head.tilt_accuracy_rad])
        return tuple(np.array(said) + half * self.rng.uniform(-1, 1, 2))

    def seen(self, uv: np.ndarray, sigma: np.ndarray) -> np.ndarray:
        """Noisy pixels, some of them wrong, NaN outside the frames."""
        inside = self.chain.model.inside(uv, 5.0)
        uv = uv + sigma[..., None] * self.rng.standard_normal(uv.shape)
        wrong = self.rng.uniform(size=sigma.shape) < self.outliers
        uv = np.where(wrong[..., None], uv + self.rng.uniform(-MATCH_OFF_PX, MATCH_OFF_PX, uv.shape), uv)
        return np.where(inside[..., None], uv, np.nan)


def rover_at(chain: Chain, ground_m: float, bearing: float = 0.1) -> ChainState:
    """A rover at rest whose markers a rig sees in the stereoscopic middle."""
    place = np.array([ground_m * np.cos(bearing), ground_m * np.sin(bearing), 0.02])
    aim = pointing_at(chain, place + [0, 0, 0.12])
    return ChainState(Transform(exp_map(np.array([0.02, -0.03, 0.4])), place), aim, (0.0, 0.9))


def dim(survey_: Survey, **changes) -> Survey:
    return replace(survey_, **changes)
