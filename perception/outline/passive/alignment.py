"""Damped Gauss-Newton over the pose at which rover, shadow and ground explain both images best.

Six parameters from a start: along the line of sight, across it, up [m]; rotation vector in site [rad].
Derivatives are differences of pictures drawn for all parameters at once.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from executive.core.ordered_sum import ordered_sum
from executive.core.types import Array
from perception.geometry.body import Transform
from perception.geometry.rotation import exp_map
from perception.outline.passive.drawing import Stands
from perception.outline.passive.matching import CameraScene, Match, match

SIZE = 6
_STEP_PX = 0.1
_CORRELATED_PX = 2.0  # how far what a drawing leaves out reaches from pixel to pixel
_ALIKE = 8.0  # pixels that err alike, and count as one
_OUTLIER = 4.0  # sigmas
_ENOUGH = 0.05  # of twice the log likelihood: a fifth of a sigma


@dataclass(frozen=True, eq=False)
class Start:
    """Where parameters are zero, and what is known besides the images: `sigma` (6,) about `mean` (6,)."""

    site_body: Transform
    sun_rad: Array
    eye_m: Array
    mean: Array
    sigma: Array

    @property
    def axes(self) -> Array:
        """Columns: along, across, up, in site."""
        ahead = self.site_body.position_m[:2] - self.eye_m[:2]
        ahead = ahead / np.linalg.norm(ahead)
        return np.array([[ahead[0], -ahead[1], 0.0], [ahead[1], ahead[0], 0.0], [0.0, 0.0, 1.0]])

    @property
    def range_m(self) -> float:
        return float(np.linalg.norm(self.site_body.position_m - self.eye_m))

    def body(self, parameters: Array) -> Transform:
        """The body at these parameters (6,)."""
        turned = exp_map(parameters[3:6]) @ self.site_body.rotation
        return Transform(turned, self.site_body.position_m + self.axes @ parameters[:3])

    def stands(self, parameters: Array) -> Stands:
        """The poses to draw for parameters (n, 6)."""
        bodies = [self.body(p) for p in parameters]
        return Stands(
            np.stack([b.rotation for b in bodies]),
            np.stack([b.position_m for b in bodies]),
            np.broadcast_to(self.sun_rad, (len(bodies), 2)),
        )

    def steps(self, focal_px: float) -> Array:
        """Parameter steps (6,) that move the picture by about a tenth of a pixel."""
        across = _STEP_PX * self.range_m / focal_px
        drop = max(self.eye_m[2] - self.site_body.position_m[2], 0.3)
        turn = across / 0.15
        return np.array([across * self.range_m / drop, across, across, turn, turn, turn])


@dataclass(frozen=True, eq=False)
class Aligned:
    """`parameters` (6,), their covariance (6, 6), the matches of both cameras, cost with priors, and
    `misfit`: squared sigmas a pixel, about 1 where everything is explained."""

    start: Start
    parameters: Array
    covariance: Array
    matches: tuple[Match, ...]
    cost: float
    misfit: float
    converged: bool

    @property
    def site_body(self) -> Transform:
        return self.start.body(self.parameters)


def align(
    scenes: Sequence[CameraScene],
    start: Start,
    parameters: Array,
    sigmas: Sequence[Array],
    focal_px: float,
    most_steps: int,
) -> Aligned:
    """Go downhill from `parameters` (6,), pixels weighed by their `sigmas` (h, w) of each camera."""
    probes = np.vstack([np.zeros(SIZE), np.diag(start.steps(focal_px))])
    weight = start.sigma**-2.0

    def shown(at: Array) -> list[Match]:
        return [match(s, start.stands(at), sigma) for s, sigma in zip(scenes, sigmas, strict=True)]

    damping, converged = 1e-3, False
    at = shown(parameters + probes)
    for _ in range(most_steps):
        H, g = _normal_equations(at, sigmas, probes)
        H[range(SIZE), range(SIZE)] += weight
        g += weight * (start.mean - parameters)
        whole = np.asarray(np.linalg.solve(H + damping * np.diag(np.diag(H)), g), dtype=np.float64)
        step = _limited(whole, start, focal_px)
        ahead = float(step @ (2 * g - H @ step))
        if ahead < _ENOUGH:
            converged = True
            break
        moved = parameters + step
        gained = _cost(at, sigmas, start, parameters) - _cost(shown(moved[None]), sigmas, start, moved)
        if gained > 0:
            parameters, at = moved, shown(moved + probes)
        damping = damping / 10 if gained > 0.5 * ahead else min(damping * 10, 1e6)
    covariance = _covariance(at, sigmas, probes, start)
    cost = _cost(at, sigmas, start, parameters)
    misfit = cost * _ALIKE / sum(sigma.size for sigma in sigmas)
    return Aligned(start, parameters, covariance, tuple(at), cost, misfit, converged)


def _cost(matches: Sequence[Match], sigmas: Sequence[Array], start: Start, parameters: Array) -> float:
    known = (parameters - start.mean) / start.sigma
    images = ordered_sum(float(_huber(m.residual[0] / s).sum()) for m, s in zip(matches, sigmas, strict=True))
    return images / _ALIKE + float(known @ known)


def _huber(rest: Array) -> Array:
    """Squares that go on as straight lines beyond `_OUTLIER`."""
    size = np.abs(rest)
    cost: Array = np.where(size < _OUTLIER, rest**2, _OUTLIER * (2 * size - _OUTLIER))
    return cost


def _scores(
    matches: Sequence[Match], sigmas: Sequence[Array], probes: Array
) -> list[tuple[Array, Array, Array]]:
    """Per camera: derivative (6, h, w) of the residuals, residuals, and their weights (h, w), in sigmas."""
    steps = probes[1:].max(axis=1)[:, None, None]
    scores = []
    for one, sigma in zip(matches, sigmas, strict=True):
        rest = one.residual[0] / sigma
        slopes = (one.residual[1:] - one.residual[:1]) / (steps * sigma)
        scores.append((slopes, rest, np.minimum(1.0, _OUTLIER / np.maximum(np.abs(rest), 1e-9))))
    return scores


def _normal_equations(
    matches: Sequence[Match], sigmas: Sequence[Array], probes: Array
) -> tuple[Array, Array]:
    H, g = np.zeros((SIZE, SIZE)), np.zeros(SIZE)
    for slopes, rest, weight in _scores(matches, sigmas, probes):
        J = slopes.reshape(SIZE, -1)
        H += (J * weight.ravel()) @ J.T
        g -= J @ (weight * rest).ravel()
    return H / _ALIKE, g / _ALIKE


def _covariance(matches: Sequence[Match], sigmas: Sequence[Array], probes: Array, start: Start) -> Array:
    """Covariance (6, 6) that allows for residuals which are correlated from pixel to pixel (sandwich)."""
    H, _ = _normal_equations(matches, sigmas, probes)
    meat = np.zeros_like(H)
    for slopes, rest, weight in _scores(matches, sigmas, probes):
        score = slopes * (weight * rest)
        near = np.stack([cv2.GaussianBlur(s, (0, 0), _CORRELATED_PX) for s in score])
        meat += score.reshape(SIZE, -1) @ near.reshape(SIZE, -1).T
    meat *= 2 * np.pi * _CORRELATED_PX**2 / _ALIKE**2
    known = np.diag(start.sigma**-2.0)
    inverse = np.linalg.inv(H + known)
    covariance: Array = inverse @ ((meat + meat.T) / 2 + known) @ inverse
    return covariance


def _limited(step: Array, start: Start, focal_px: float) -> Array:
    """A step that moves nothing by more than some pixels."""
    most = 30 * start.steps(focal_px)
    return step * min(1.0, float((most / np.maximum(np.abs(step), 1e-12)).min()))
