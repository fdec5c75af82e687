"""The rover on its way: from two frames of both cameras to where it is, and how far it came between them.

What moved is found in each camera (outline.motion), the rover's outline is laid on it from coarse to fine
(outline.outline_fit), and its surfaces are found again in the first frame. Neither the prediction's place
nor the ground's height has a say in where that is, as long as both cameras see it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from executive.core.ordered_sum import ordered_sum
from executive.core.types import (
    LEFT,
    RIGHT,
    Array,
    Images,
    Window,
)
from perception.frames.shots import check_frames
from perception.frames.steadying import Picture
from perception.geometry.body import Transform
from perception.geometry.chain import Chain
from perception.geometry.coarse_position import coarse_position
from perception.geometry.prediction import Expectation
from perception.geometry.rotation import rot_z
from perception.outline.motion import LEAST_SIDE_PX, Fragments, motion_fragments
from perception.outline.outline_fit import (
    Lie,
    lay_outlines,
    step_between,
    support,
)
from perception.outline.silhouette import Outline

_WORKING_PX = 64.0  # a rover as long as this shows what is needed; nearer ones are binned
# Rovers have 0.43 and 0.54 or more; where chance has put specks under an outline, one of both is less.
_LEAST_ALIKE, _LEAST_COVERED = 0.4, 0.5
_LEAST_EVIDENT = 0.25  # the same of what itself moved; rovers have 0.29 or more up to 10 m
_SPARSE, _PLAIN = 4, 3.0  # a picture whose contrast is below so many pixel noises shows nothing
_LARGEST_TURN_RAD = math.radians(5.0)
_MOST_APART_PX = 1.5  # binned, between what is seen and what a point in space can show
_LIE_SIGMA_PX, _STEP_SIGMA_PX = 0.12, 0.30  # binned
_SHAPE_SIGMA_M = 0.006  # what the drawing leaves out, and a heading that is off
_STEP_SHAPE_SIGMA_M = 0.002  # of a step: a rover that pitches shows other edges
_HEIGHT_SIGMA_M = 0.03
_CLIMB_SIGMA_M = 0.007  # of a step: it mostly follows the ground
_UNKNOWN_M = 10.0
_GATE = 4.0  # sigmas
_SHAKE_PX = 3.0 / math.sqrt(3.0)  # how far a vibrating head is from where it says, per axis


@dataclass(frozen=True)
class _Pass:
    """One pass of the search: on what moved, halved, or on all lines near that; how far around, how soft the
    outline [px], and turned by which parts of the heading's sigma."""

    halvings: int
    reach_px: int
    blur_px: float
    turns: tuple[float, ...] = (0.0,)


_PASSES = (_Pass(2, 20, 1.5), _Pass(1, 14, 1.0, (-1.0, 0.0, 1.0)), _Pass(1, 4, 1.0))


@dataclass(frozen=True, eq=False)
class Moving:
    """A rover on its way, in site.

    `position_m` (3,) is its place at the second frame, `step_m` (3,) what it moved since the first, each
    with its covariance (3, 3); `regions` are the fragments' in the full frames, None where a camera saw
    none; `alike` is how well the outline fits what moved (a correlation, of the worse camera).
    """

    position_m: Array
    covariance: Array
    step_m: Array
    step_covariance: Array
    regions: tuple[Window | None, Window | None]
    alike: float


def moving_rover(chain: Chain, expectation: Expectation, images: Images, range_m: float) -> Moving | None:
    """Find a rover of the expected attitude between a shot's first frame and its last.

    None where nothing moved that looks like it. The expected height counts only for one camera alone.
    ValueError unless the frames are as ordered (perception.frames.shots).
    """
    check_frames(images, chain.rig.sensor)
    search = _Search.of(chain, expectation, images, range_m)
    if search is None or not search.fragments:
        return None
    found: _Found | None = _Found(expectation.state.site_body, np.eye(3), (), 0.0)
    for each in _PASSES:
        found = None if found is None else search.look(found.site_body, each)
    if found is None or not (found.credible and search.evident(found) and search.on_the_ground(found)):
        return None
    step, step_covariance = search.step(found)
    return Moving(
        position_m=found.site_body.position_m,
        covariance=found.covariance + np.eye(3) * _SHAPE_SIGMA_M**2 + search.head_share(found),
        step_m=step,
        step_covariance=step_covariance,
        regions=search.regions(),
        alike=found.alike,
    )


@dataclass(frozen=True, eq=False)
class _Found:
    """Where a pass put the rover, covariance of that, how the outlines lie, and how far they contradict."""

    site_body: Transform
    covariance: Array
    lies: Sequence[Lie]
    apart_px: float

    @property
    def alike(self) -> float:
        """How well the outline fits, of the worse camera."""
        return min(lie.alike for lie in self.lies)

    @property
    def credible(self) -> bool:
        """Whether enough of the outline is there, in each camera and at one place in space."""
        covered = min(lie.covered for lie in self.lies)
        alike = self.alike >= _LEAST_ALIKE and covered >= _LEAST_COVERED
        return alike and self.apart_px <= _MOST_APART_PX


@dataclass(frozen=True, eq=False)
class _Search:
    """What moved, per camera that saw anything, and what is known of the rover and the head."""

    chain: Chain
    expectation: Expectation
    head_rad: tuple[float, float]
    binning: int
    fragments: dict[int, Fragments]

    @classmethod
    def of(cls, chain: Chain, expectation: Expectation, images: Images, range_m: float) -> _Search | None:
        rover_px = chain.rig.cameras[0].focal_px * chain.rig.rover.length_m / range_m
        smallest = min(min(w.width, w.height) for w in images.windows)
        binning = max(1, min(round(rover_px / _WORKING_PX), smallest // LEAST_SIDE_PX))
        fragments = {}
        for camera, (window, stack) in enumerate(zip(images.windows, images.counts, strict=True)):
            noise, corner = chain.rig.sensor.noise_counts, (window.u, window.v)
            moved = motion_fragments(stack[0], stack[-1], noise, corner, rover_px, binning)
            if moved is not None:
                fragments[camera] = moved
            elif float(np.std(stack[-1][::_SPARSE, ::_SPARSE])) > _PLAIN * noise:
                return None  # what moves for one camera moves for the other, unless that is blind
        head_rad = (images.head.pan_rad, images.head.tilt_rad)
        return cls(chain, expectation, head_rad, binning, fragments)

    def look(self, site_body: Transform, each: _Pass) -> _Found | None:
        """Lay the outlines near a pose, at the heading that fits best; None where they do not fall into the
        pictures, or contradict each other."""
        outlines = [self._outline(camera, each.halvings) for camera in self.fragments]
        pictures = [_halved(f.edges) if each.halvings > 1 else f.lines for f in self.fragments.values()]
        sigma = min(math.sqrt(self.expectation.covariance[5, 5]), _LARGEST_TURN_RAD)
        best: tuple[Transform, Sequence[Lie]] | None = None
        for turn in each.turns:
            body = Transform(rot_z(turn * sigma) @ site_body.rotation, site_body.position_m)
            lies = lay_outlines(outlines, pictures, body, each.reach_px, each.blur_px)
            if lies is not None and (best is None or _fit(lies) > _fit(best[1])):
                best = body, lies
        return None if best is None else self._placed(outlines, *best)

    def _placed(self, outlines: list[Outline], site_body: Transform, lies: Sequence[Lie]) -> _Found | None:
        """The pose that outlines, laid from an expected one, amount to; None if there is none."""
        middle = self._middle(site_body)
        uv = np.full((2, 2), np.nan)
        for outline, lie in zip(outlines, lies, strict=True):
            uv[outline.camera] = outline.full_px(outline.pixels(middle[None])[0] + lie.off_px)
        head = self.chain.site_ih(self.head_rad)
        up = head.rotation.T @ [0.0, 0.0, 1.0]
        height = self._middle(self.expectation.state.site_body)[2] - head.position_m[2]
        sigma_height = self._height_sigma_m() if len(outlines) == 1 else _UNKNOWN_M
        sigma_px = np.full(2, _LIE_SIGMA_PX * outlines[0].binning)
        point, P = coarse_position(self.chain.model, uv, sigma_px, (up, height, sigma_height))
        moved = Transform(site_body.rotation, site_body.position_m + head.apply(point[None])[0] - middle)
        off = self.chain.model.project(point[None])[:, 0] - uv
        off = off[[outline.camera for outline in outlines]]
        if not np.isfinite(off).all():  # lines of sight that part: in front of the cameras they do not meet
            return None
        apart_px = float(np.abs(off).max()) / outlines[0].binning
        return _Found(moved, head.rotation @ P @ head.rotation.T, lies, apart_px)

    def evident(self, found: _Found) -> bool:
        """Whether enough of the outline lies on what itself moved, in each camera."""
        pairs = zip(self.fragments.values(), found.lies, strict=True)
        support_each = [support(f.edges, lie.sketch, np.round(lie.off_px)) for f, lie in pairs]
        return min(min(each) for each in support_each) >= _LEAST_EVIDENT

    def on_the_ground(self, found: _Found) -> bool:
        """Whether the height of what was found may be that of the ground there."""
        sigma = math.hypot(self._height_sigma_m(), math.sqrt(found.covariance[2, 2]))
        off = found.site_body.position_m[2] - self.expectation.state.site_body.position_m[2]
        return bool(abs(off) <= _GATE * sigma)

    def head_share(self, found: _Found) -> Array:
        """What the head's accuracy and its shaking do to a position, across the line of sight (3, 3)."""
        sight = found.site_body.position_m - self.chain.site_ih(self.head_rad).position_m
        shake_rad = _SHAKE_PX / self.chain.rig.cameras[0].focal_px
        sigma_rad = math.hypot(float(self.chain.encoder_sigma_rad()[:2].max()), shake_rad)
        share: Array = sigma_rad**2 * (np.eye(3) * float(sight @ sight) - np.outer(sight, sight))
        return share

    def step(self, found: _Found) -> tuple[Array, Array]:
        """What the rover moved between the frames (3,) [m], and its covariance (3, 3)."""
        head = self.chain.site_ih(self.head_rad)
        point_ih = head.inverse().apply(self._middle(found.site_body)[None])
        _, J = self.chain.model.project_with_jacobian(point_ih)
        by_site = J[list(self.fragments), 0].mean(axis=0) @ head.rotation.T / self.binning
        seen = step_between(list(self.fragments.values()), list(found.lies))
        weight = 0.0 if seen is None else _STEP_SIGMA_PX**-2
        H = np.diag([_UNKNOWN_M**-2, _UNKNOWN_M**-2, _CLIMB_SIGMA_M**-2]) + weight * by_site.T @ by_site
        P = np.linalg.inv(H)
        step = np.zeros(3) if seen is None else P @ by_site.T @ seen * weight
        return step, P + np.eye(3) * _STEP_SHAPE_SIGMA_M**2

    def regions(self) -> tuple[Window | None, Window | None]:
        left, right = (self.fragments.get(camera) for camera in (LEFT, RIGHT))
        return None if left is None else left.region, None if right is None else right.region

    def _outline(self, camera: int, halvings: int) -> Outline:
        corner = self.fragments[camera].corner_px
        joints = self.expectation.state.joints_rad
        return Outline(self.chain, joints, self.head_rad, camera, self.binning * halvings, corner)

    def _height_sigma_m(self) -> float:
        """How well the height of the ground there is known."""
        return math.hypot(math.sqrt(self.expectation.covariance[2, 2]), _HEIGHT_SIGMA_M)

    def _middle(self, site_body: Transform) -> Array:
        """The middle (3,) of the rover's height."""
        up: Array = site_body.rotation[:, 2]
        return site_body.position_m + up * self.chain.rig.rover.height_m / 2


def _fit(lies: Sequence[Lie]) -> float:
    """How well outlines fit, of all cameras."""
    return ordered_sum(lie.alike for lie in lies)


def _halved(edges: Picture) -> Picture:
    size = (edges.shape[1] // 2, edges.shape[0] // 2)
    small = cv2.resize(edges, size, interpolation=cv2.INTER_AREA)
    return np.asarray(cv2.GaussianBlur(small, (0, 0), 1.0), dtype=np.float32)
