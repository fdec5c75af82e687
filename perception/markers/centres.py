"""Find a marker in a difference image: matched filter, then a maximum-likelihood fit of its centre.

The filter is the expected point spread; its output over its own noise is the SNR of a marker centred
there. Peaks above a threshold set by the false-alarm rate for the whole window are fitted for column, row
and flux; the covariance of the centre is the Cramer-Rao bound at the fitted flux, plus its measured excess.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from executive.core.types import Array
from perception.frames.psf import Spread
from perception.kernels.compiled import plain
from perception.kernels.light import centre_fit

# Beyond the bound: by how much the centre's variance exceeds it, times SNR^4. Centres alone have 0.16, 0.09,
# 0.05, 0.05, 0.03 of it at SNR 6, 7, 8, 9, 12 (6000 each, 1.6 to 5 m); poses, whose centres are weighed by
# their fitted fluxes, ask for 0.09 at 8.2 and 0.05 at 9 (9000 poses).
_EXCESS_SNR4 = 350.0
_SPIKE_SIGMAS = 6.0
_SPIKE_SLACK_SIGMAS = 1.5
_NO_WORD = np.float32(1e3)
SIGMA_FLOOR_PX = 0.01  # what is left of lens calibration and spread model


@dataclass(frozen=True, eq=False)
class Detection:
    """A marker candidate: centre in full-frame pixels (u, v) with covariance (2, 2) [px2], flux [counts]."""

    uv_px: Array
    covariance_px2: Array
    flux_counts: float
    flux_sigma_counts: float

    @property
    def snr(self) -> float:
        return self.flux_counts / self.flux_sigma_counts


def detection_threshold(pixels: int, false_alarm_rate: float) -> float:
    """SNR that noise alone exceeds somewhere among `pixels` filter outputs at this rate (one-sided)."""
    if pixels < 1 or not 0 < false_alarm_rate < 1:
        raise ValueError(f"got {pixels} pixels at rate {false_alarm_rate}, expected 1 or more, in (0, 1)")
    return float(-ndtri(false_alarm_rate / pixels))


def filter_snr(image: NDArray[np.float32], sigma: NDArray[np.float32], spread: Spread) -> NDArray[np.float32]:
    """SNR (h, w) of a marker centred at each pixel of a difference image with noise `sigma` (h, w)."""
    line = spread.line().astype(np.float32)
    weight = np.asarray(1.0 / np.square(sigma), dtype=np.float32)
    signal = _filtered(image * weight, line)
    power = _filtered(weight, line**2)
    return np.asarray(signal / np.sqrt(np.maximum(power, 1e-20)), dtype=np.float32)


def _filtered(image: NDArray[np.float32], line: NDArray[np.float32]) -> NDArray[np.float32]:
    """Correlation with the outer product of `line` with itself; zero beyond the rim."""
    out = cv2.sepFilter2D(image, cv2.CV_32F, line, line, borderType=cv2.BORDER_CONSTANT)
    return np.asarray(out, dtype=np.float32)


def find_markers(
    image: NDArray[np.float32],
    sigma: NDArray[np.float32],
    spread: Spread,
    corner_px: tuple[int, int] = (0, 0),
    false_alarm_rate: float = 1e-3,
    at_most: int = 4,
) -> list[Detection]:
    """Marker candidates of one difference image (h, w) [counts], the brightest first.

    `corner_px` is the full-frame (column, row) of the image's first pixel. Raises ValueError on arrays of
    other shapes, smaller than the spread, or with values that are not finite.
    """
    _check(image, sigma, spread)
    image, sigma = _without_spikes(image, sigma, spread)
    threshold = detection_threshold(image.size, false_alarm_rate)
    snr = filter_snr(image, sigma, spread)
    found = (_fit(image, sigma, spread, u, v) for u, v in _peaks(snr, threshold, 2 * at_most))
    kept: list[Detection] = []
    for detection in sorted((d for d in found if d is not None), key=lambda d: -d.snr):
        apart = all(np.hypot(*(detection.uv_px - k.uv_px)) > spread.radius_px / 2 for k in kept)
        if apart and detection.snr > 0.9 * threshold:
            kept.append(detection)
    corner = np.array(corner_px, dtype=float)
    return [
        Detection(d.uv_px + corner, d.covariance_px2, d.flux_counts, d.flux_sigma_counts)
        for d in kept[:at_most]
    ]


def _check(image: NDArray[np.float32], sigma: NDArray[np.float32], spread: Spread) -> None:
    least = 2 * spread.radius_px + 1
    if image.ndim != 2 or min(image.shape) < least or sigma.shape != image.shape:
        raise ValueError(
            f"got an image of shape {image.shape} with noise of shape {sigma.shape}, "
            f"expected both ({least} or more, {least} or more)"
        )
    if not (np.isfinite(image).all() and np.isfinite(sigma).all() and sigma.min() > 0):
        raise ValueError(
            "got an image with non-finite values or noise of 0, expected finite and positive noise"
        )


def _without_spikes(
    image: NDArray[np.float32], sigma: NDArray[np.float32], spread: Spread
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """The image without pixels that no marker could light: far below zero, or so much brighter than all four
    beside them as its spread never is. They keep their place at a noise that takes their say."""
    rows, columns = _places(image > _SPIKE_SIGMAS * sigma)
    spikes = image < -_SPIKE_SIGMAS * sigma
    if len(rows):
        beside = np.pad(image / sigma, 1)
        around = [beside[rows + i, columns + j] for i, j in ((0, 1), (1, 0), (1, 2), (2, 1))]
        fall = spread.profile(np.ones(1))[0] / spread.profile(np.zeros(1))[0]
        expected = 0.5 * float(fall) * image[rows, columns] / sigma[rows, columns]
        spikes[rows, columns] = expected - np.max(around, axis=0) > _SPIKE_SLACK_SIGMAS
    if not spikes.any():
        return image, sigma
    quiet = np.where(spikes, np.float32(0), image)
    return quiet, np.where(spikes, _NO_WORD * sigma, sigma).astype(np.float32)


def _peaks(snr: NDArray[np.float32], threshold: float, at_most: int) -> list[tuple[int, int]]:
    """Columns and rows of local maxima above the threshold, the highest first."""
    highest = cv2.dilate(snr, np.ones((3, 3), np.uint8), borderType=cv2.BORDER_REPLICATE)
    rows, columns = _places((snr >= highest) & (snr > threshold))
    order = np.argsort(-snr[rows, columns])[:at_most]
    return [(int(columns[i]), int(rows[i])) for i in order]


def _places(where: NDArray[np.bool_]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Rows and columns of what is true; where little is, several times as fast as `nonzero` of two axes."""
    rows, columns = np.divmod(np.flatnonzero(where), where.shape[1])
    return rows, columns


def _fit(
    image: NDArray[np.float32], sigma: NDArray[np.float32], spread: Spread, u: int, v: int
) -> Detection | None:
    """Maximum-likelihood centre and flux from the peak at (u, v); None if the fit runs away."""
    r = spread.radius_px + 1
    top, left = max(v - r, 0), max(u - r, 0)
    patch = plain(image[top : v + r + 1, left : u + r + 1])
    weight = plain(sigma[top : v + r + 1, left : u + r + 1]) ** -2
    x, y, flux, F, found = centre_fit(patch, weight, u - left, v - top, spread.box_px, spread.sigma_px)
    if not found:
        return None
    covariance = np.linalg.inv(F)
    snr_squared = flux**2 / covariance[0, 0]
    excess = 1 + _EXCESS_SNR4 / snr_squared**2
    centre = covariance[1:, 1:] * excess + SIGMA_FLOOR_PX**2 * np.eye(2)
    return Detection(np.array([left + x, top + y]), centre, flux, math.sqrt(covariance[0, 0]))
