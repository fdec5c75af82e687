"""Coarse joint detection: where in the prediction's window do all markers in both cameras light up together?

A hypothesis is (distance, heading, column, row). Distance and heading fix the pattern that the markers make
in the two images; moving that pattern by whole columns is turning the rover about the mast, by whole rows
lifting it. So for each pattern the scores of all places are a sum of shifted matched-filter images, and the
lattice is as fine as the filter's width asks, no finer.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from executive.core.types import Array
from perception.frames.psf import Spread
from perception.geometry.body import Transform
from perception.geometry.chain import Chain, ChainState
from perception.geometry.prediction import Expectation
from perception.geometry.rotation import exp_map, rot_z
from perception.kernels.lattice import best_shifts

REGION_SIGMAS = 3.5
_STEP_WIDTHS = 1.3  # of the lattice: the farthest a marker moves from one pattern to the next, in its widths
_ROOM_PX = 2.0
_UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, eq=False)
class FilterImages:
    """One camera's matched-filter SNR, an image a marker (n, h, w), and its corner's full-frame place."""

    snr: NDArray[np.float32]
    corner_px: tuple[int, int]


@dataclass(frozen=True, eq=False)
class PoseCandidate:
    """A pose and the joint SNR that all markers have there."""

    state: ChainState
    snr: float


@dataclass(frozen=True, eq=False)
class _Motion:
    """Pixels (2, n, 2) by which a body moves in the images: away from the mast, turning on the spot,
    about the mast, up."""

    away: Array
    turn: Array
    about_mast: Array
    up: Array

    @classmethod
    def of(cls, chain: Chain, state: ChainState) -> _Motion:
        _, J = chain.project(state)
        x, y, _ = position = state.site_body.position_m
        away = np.array([x, y, 0.0]) / max(math.hypot(x, y), 1e-9)
        about = J[..., :3] @ np.cross(_UP, position) + J[..., 5]
        return cls(J[..., :3] @ away, J[..., 5], about, J[..., 2])


@dataclass(frozen=True, eq=False)
class Lattice:
    """The hypotheses: poses of all distances and headings, the patterns (p, 2, n, 2) that their markers make,
    half-widths in columns and rows, and the volume of place and heading [m2 rad] that they span."""

    poses: list[ChainState]
    uv_px: Array
    columns: int
    rows: int
    column_per_rad: float
    row_per_m: float
    volume: float

    @classmethod
    def of(cls, chain: Chain, expectation: Expectation, spread: Spread, widen: float) -> Lattice:
        state, reach, step_px = expectation.state, REGION_SIGMAS * widen, _STEP_WIDTHS * spread.width_px
        motion = _Motion.of(chain, state)
        x, y, _ = state.site_body.position_m
        distance = max(math.hypot(x, y), 0.1)
        away = np.array([x, y]) / distance
        P = expectation.covariance
        across = np.array([-away[1], away[0]])
        sigma_away = math.sqrt(away @ P[:2, :2] @ away)
        sigma_bearing = math.hypot(
            math.sqrt(across @ P[:2, :2] @ across) / distance, chain.encoder_sigma_rad()[0]
        )
        per_rad, per_m = float(motion.about_mast[..., 0].mean()), float(motion.up[..., 1].mean())
        half_away = min(reach * sigma_away, 0.8 * distance)
        half_turn = min(reach * math.hypot(math.sqrt(P[5, 5]), sigma_bearing), math.pi)
        columns = math.ceil(reach * sigma_bearing * abs(per_rad) + _ROOM_PX)
        distances, turns = (
            _steps(half_away, motion.away, step_px),
            _steps(half_turn, motion.turn, step_px),
        )
        seen = [
            (one, uv)
            for one in _poses(state, distances, turns)
            if np.isfinite(uv := chain.project(one)[0]).all()
        ]
        return cls(
            [one for one, _ in seen],
            np.array([uv for _, uv in seen]).reshape(-1, 2, len(chain.markers_plc_m), 2),
            columns,
            math.ceil(reach * math.sqrt(P[2, 2]) * abs(per_m) + _ROOM_PX),
            per_rad,
            per_m,
            8 * half_away * half_turn * columns / abs(per_rad) * distance,
        )

    def best(
        self, cameras: Sequence[FilterImages], used: NDArray[np.bool_], at_most: int
    ) -> list[PoseCandidate]:
        """The best hypotheses by the light of the used markers (n,), one a pattern, best first."""
        left, right = cameras
        corners = np.array([left.corner_px, right.corner_px], dtype=np.int64)
        images = left.snr, right.snr
        sums, shifts = best_shifts(images, corners, used, self.uv_px, self.rows, self.columns)
        scale = 1 / math.sqrt(2 * len(used))
        first = np.argsort(-sums, kind="stable")[:at_most].tolist()
        return [
            PoseCandidate(self._moved(self.poses[k], *shifts[k].tolist()), scale * float(sums[k]))
            for k in first
        ]

    def _moved(self, state: ChainState, rows: int, columns: int) -> ChainState:
        """The state whose pattern is shifted by so many pixels: about the mast, and up or down."""
        about = exp_map(_UP * (columns / self.column_per_rad))
        lift = _UP * (rows / self.row_per_m)
        body = state.site_body
        return ChainState(
            Transform(about @ body.rotation, about @ body.position_m + lift), state.head_rad, state.joints_rad
        )


def _poses(expected: ChainState, away_m: Array, turn_rad: Array) -> Iterator[ChainState]:
    """The expected state moved away and turned on the spot."""
    body = expected.site_body
    outward = body.position_m * [1.0, 1.0, 0.0] / max(math.hypot(*body.position_m[:2]), 1e-9)
    for away, turn in itertools.product(away_m.tolist(), turn_rad.tolist()):
        moved = Transform(rot_z(turn) @ body.rotation, body.position_m + away * outward)
        yield ChainState(moved, expected.head_rad, expected.joints_rad)


def _steps(half_width: float, motion_px: Array, step_px: float) -> Array:
    """Offsets within +-half_width, so fine that no marker strays from the pattern by more than `step_px`."""
    strays = float(np.linalg.norm(motion_px - motion_px.mean(axis=(0, 1)), axis=-1).max())
    count = math.ceil(half_width * strays / step_px)
    return np.linspace(-half_width, half_width, 2 * count + 1)
