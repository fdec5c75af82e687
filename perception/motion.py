"""Motion fragment analysis (MFA): two images of a moving rover -> where it is, roughly (paper, 4.1).

The rover as a whole is the marker: where two frames differ, after the head's own movement and the change
of light are taken out, there it was or is. Cheap, approximate, and it forgives vibration.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from executive.types import Array, Vec2, Window
from perception.camera import StereoModel
from perception.checks import as_finite

Image = NDArray[np.float32]

_SMOOTH_PX = 1.5
_SMOOTH_NOISE = 1 / (2 * np.sqrt(np.pi) * _SMOOTH_PX)  # what the smoothing leaves of white noise
_THRESHOLD_NOISES = 5.0
_REGISTRATION_PX = 0.3  # how far off the frames may lie on each other
_LEAST_AREA_PX = 12
_MATCH_SCORE = 0.5
_LARGEST_SHIFT_PX = 40


@dataclass(frozen=True)
class Fragments:
    """Motion in one camera, full-frame pixels: where the fragments' middle is, the region that holds them,
    their area, and by how much the picture moved from the first frame to the second (None if unclear)."""

    centre_px: Vec2
    region: Window
    area_px: int
    shift_px: Vec2 | None

    @property
    def latest_px(self) -> Vec2:
        """The middle at the second frame: fragments lie halfway between the two."""
        du, dv = self.shift_px or (0.0, 0.0)
        return self.centre_px[0] + du / 2, self.centre_px[1] + dv / 2


def motion_fragments(
    before: NDArray[np.uint16],
    after: NDArray[np.uint16],
    noise_counts: float,
    corner_px: tuple[int, int] = (0, 0),
    reach_px: float = 400.0,
) -> Fragments | None:
    """Fragments between two frames (h, w) [counts], None if nothing moved; ValueError on unequal shapes.

    `reach_px` is how far from the largest fragment others still belong to the rover: its size in pixels.
    """
    if before.ndim != 2 or before.shape != after.shape or min(before.shape) < 32:
        raise ValueError(
            f"got frames of shape {before.shape} and {after.shape}, expected two equal, 32 or more"
        )
    first, second = before.astype(np.float32), after.astype(np.float32)
    head_shift = _common_shift(first, second)
    second = _matched_light(first, _moved(second, head_shift))
    change = np.asarray(cv2.GaussianBlur(second - first, (0, 0), _SMOOTH_PX), dtype=np.float32)
    allowance = _THRESHOLD_NOISES * _change_noise(change, noise_counts) + _REGISTRATION_PX * _steepness(first)
    marked = _fragment_mask(change, allowance)
    _clear_rim(marked, head_shift)
    mask = _near_largest(marked, reach_px)
    if not mask.any():
        return None
    rows, columns = np.nonzero(mask)
    region = Window(int(columns.min()), int(rows.min()), int(np.ptp(columns)) + 1, int(np.ptp(rows)) + 1)
    shift = _rover_shift(first, second, region)
    centre = np.array([(columns.min() + columns.max()) / 2, (rows.min() + rows.max()) / 2])
    centre = 0.5 * centre + 0.5 * np.array([columns.mean(), rows.mean()])
    # Second-frame pixels: undo the head's own movement, so that they belong to the latest view.
    u, v = centre + head_shift + np.array(corner_px)
    moved_region = Window(region.u + corner_px[0], region.v + corner_px[1], region.width, region.height)
    return Fragments((float(u), float(v)), moved_region, int(mask.sum()), shift)


def _common_shift(first: Image, second: Image) -> Array:
    """Movement of the whole picture (u, v) [px]; zero unless undoing it makes the pictures more alike."""
    window = cv2.createHanningWindow(first.shape[::-1], cv2.CV_32F)
    (du, dv), _ = cv2.phaseCorrelate(first - first.mean(), second - second.mean(), window)
    shift = np.array([du, dv])
    if np.abs(shift).max() > _LARGEST_SHIFT_PX:
        return np.zeros(2)
    still = np.median(np.abs(_matched_light(first, second) - first))
    undone = np.median(np.abs(_matched_light(first, _moved(second, shift)) - first))
    return shift if undone < 0.98 * still else np.zeros(2)


def _moved(image: Image, shift_px: Array) -> Image:
    """The image with a movement undone; what comes in at the rim repeats the rim."""
    if not shift_px.any():
        return image
    M = np.array([[1.0, 0.0, -shift_px[0]], [0.0, 1.0, -shift_px[1]]])
    moved = cv2.warpAffine(
        image, M, image.shape[::-1], flags=cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE
    )
    return np.asarray(moved, dtype=np.float32)


def _matched_light(first: Image, second: Image) -> Image:
    """`second` with gain and offset that fit it to `first`, refitted without the pixels that moved."""
    a, b = first.ravel()[::7], second.ravel()[::7]
    keep = np.ones(a.shape, dtype=bool)
    gain, offset = 1.0, 0.0
    for _ in range(3):
        spread = float(b[keep].var())
        covariance = float(((a[keep] - a[keep].mean()) * (b[keep] - b[keep].mean())).mean())
        gain = float(np.clip(covariance / spread, 0.5, 2.0)) if spread > 1e-6 else 1.0
        offset = float(a[keep].mean() - gain * b[keep].mean())
        rest = np.abs(a - gain * b - offset)
        keep = rest <= 2.5 * max(float(np.median(rest)), 1e-3)
    return np.asarray(gain * second + offset, dtype=np.float32)


def _change_noise(change: Image, noise_counts: float) -> float:
    """Noise of the smoothed change [counts]: measured robustly, not below what the sensor alone makes."""
    measured = float(np.median(np.abs(change))) * 1.4826
    return max(measured, noise_counts * float(np.sqrt(2.0) * _SMOOTH_NOISE))


def _steepness(image: Image) -> Image:
    """Slope of the smoothed picture [counts/px]: what a pixel of wrong registration would change."""
    along_v, along_u = np.gradient(np.asarray(cv2.GaussianBlur(image, (0, 0), _SMOOTH_PX), dtype=np.float32))
    slope = np.hypot(along_u, along_v).astype(np.float32)
    return np.asarray(cv2.dilate(slope, np.ones((3, 3), np.uint8)), dtype=np.float32)


def _clear_rim(mask: NDArray[np.uint8], head_shift: Array) -> None:
    """Blank, in place, what one of the frames did not see, and the rim where smoothing has no neighbours."""
    rim = int(np.ceil(np.abs(head_shift).max())) + 3
    mask[:rim], mask[-rim:], mask[:, :rim], mask[:, -rim:] = 0, 0, 0, 0


def _fragment_mask(change: Image, allowance: Image) -> NDArray[np.uint8]:
    """Where the change stands out: thresholded, specks opened away, neighbours closed together."""
    mask = (np.abs(change) > allowance).astype(np.uint8)
    mask = cv2.morphologyEx(mask, cv2.MORPH_OPEN, np.ones((3, 3), np.uint8)).astype(np.uint8)
    return np.asarray(cv2.morphologyEx(mask, cv2.MORPH_CLOSE, np.ones((9, 9), np.uint8)), dtype=np.uint8)


def _near_largest(mask: NDArray[np.uint8], reach_px: float) -> NDArray[np.bool_]:
    """The blobs within reach of the largest one (their centroids); all False if there is none."""
    count, labels, stats, centroids = cv2.connectedComponentsWithStats(mask, connectivity=8)
    areas = stats[:, cv2.CC_STAT_AREA].copy()
    areas[0] = 0
    if count < 2 or areas.max() < _LEAST_AREA_PX:
        return np.zeros(mask.shape, dtype=bool)
    distance = np.linalg.norm(centroids - centroids[int(areas.argmax())], axis=1)
    kept = (distance <= reach_px) & (areas >= _LEAST_AREA_PX)
    result: NDArray[np.bool_] = kept[labels]
    return result


def _rover_shift(first: Image, second: Image, region: Window) -> Vec2 | None:
    """Movement of the region's content by template matching [px], sub-pixel; None if unclear."""
    template = first[region.v : region.v + region.height, region.u : region.u + region.width]
    reach = min(_LARGEST_SHIFT_PX, max(template.shape))
    v0, u0 = max(region.v - reach, 0), max(region.u - reach, 0)
    field = second[v0 : region.v + region.height + reach, u0 : region.u + region.width + reach]
    score = np.asarray(cv2.matchTemplate(field, template, cv2.TM_CCOEFF_NORMED), dtype=np.float32)
    _, best, _, (column, row) = cv2.minMaxLoc(score)
    if not best > _MATCH_SCORE:
        return None
    du = column + _vertex(score[row, max(column - 1, 0) : column + 2])
    dv = row + _vertex(score[max(row - 1, 0) : row + 2, column])
    return float(u0 + du - region.u), float(v0 + dv - region.v)


def _vertex(three: Image) -> float:
    """Offset of the maximum of a parabola through three samples from the middle one; 0 at a rim."""
    if three.size != 3:
        return 0.0
    a, b, c = (float(x) for x in three)
    bend = a - 2 * b + c
    return 0.0 if bend >= 0 else 0.5 * (a - c) / bend


def coarse_position(
    model: StereoModel, uv_px: Array, sigma_px: Array, height_ih: tuple[Array, float, float]
) -> tuple[Array, Array]:
    """A point (3,) in `ih` and its covariance from pixels (2, 2) with sigmas (2,), and a known height.

    `height_ih` is the plane the point lies on as (unit normal in ih, offset along it [m], sigma [m]).
    A camera that saw nothing is NaN; one is enough. ValueError if neither saw anything.
    """
    normal, offset, sigma_height = as_finite("normal", height_ih[0], (3,)), height_ih[1], height_ih[2]
    seen = np.isfinite(uv_px).all(axis=1)
    if not seen.any():
        raise ValueError("uv_px: got NaN for both cameras, expected at least one to see the rover")
    rays = model.rays_ih(uv_px[:, None])[:, 0]
    centre, ray = model.position_ih_m[seen][0], rays[seen][0]
    point = centre + ray * (offset - normal @ centre) / (normal @ ray)
    H = np.eye(3)
    for _ in range(5):
        uv, J = model.project_with_jacobian(point[None])
        w = sigma_px[seen] ** -2.0
        A, off = J[seen, 0], (uv_px - uv[:, 0])[seen]
        H = np.einsum("cki,c,ckj->ij", A, w, A) + np.outer(normal, normal) / sigma_height**2
        g = np.einsum("cki,c,ck->i", A, w, off) + normal * (offset - normal @ point) / sigma_height**2
        point = point + np.linalg.solve(H, g)
    return point, np.asarray(np.linalg.inv(H), dtype=np.float64)
