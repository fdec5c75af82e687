"""Fits of light, profiles and the equalising of frames against plain numpy."""

import numpy as np
import pytest

from perception.frames.psf import Spread
from perception.kernels.frames import equalised, mean_and_range
from perception.kernels.lattice import add_pattern, best_shifts
from perception.kernels.light import local_fits, normal_equations_with_light
from tests.perception.synthetic import spot

SPREAD = Spread(0.8, 0.6)


@pytest.fixture
def window():
    """Images (3, 30, 40) of noise with their weights, markers (3, 2) at full-frame pixels, a corner."""
    rng = np.random.default_rng(1)
    images, weights = rng.standard_normal((3, 30, 40)), rng.uniform(0.5, 2.0, (3, 30, 40))
    return (
        images,
        weights,
        np.array([100.0, 200.0]),
        np.array([[110.2, 211.7], [129.5, 220.1], [120.0, 215.5]]),
    )


def fits(images, weights, corner, uv, flux):
    return local_fits(images, weights, corner, uv, flux, SPREAD.box_px, SPREAD.sigma_px, 4)


def test_a_fit_is_the_slope_and_curvature_of_the_likelihood(window):
    images, weights, corner, uv = window
    flux = np.array([20.0, 5.0, 0.0])
    shown = np.zeros_like(images)
    for m, (u, v) in enumerate(uv - corner):
        shown[m] = 10.0 * np.outer(SPREAD.profile(np.arange(30) - v), SPREAD.profile(np.arange(40) - u))

    def gain(step):
        return fits(shown, weights, corner, uv + step[1:], flux + step[0])[2]

    information, score, total = fits(shown, weights, corner, uv, flux)
    slope = [(gain(s) - gain(-s)) / 2e-5 / 2 for s in np.eye(3) * 1e-5]
    np.testing.assert_allclose(score.sum(axis=0), slope, rtol=1e-6)
    assert total > 0
    np.testing.assert_allclose(information, np.swapaxes(information, 1, 2), rtol=1e-12)
    right, _, _ = fits(shown, weights, corner, uv, np.full(3, 10.0))
    curvature = np.zeros((3, 3))
    for i, s in enumerate(np.eye(3) * 1e-4):
        up, down = (
            fits(shown, weights, corner, uv + k * s[1:], 10.0 + k * s[0] * np.ones(3)) for k in (1, -1)
        )
        curvature[i] = (down[1] - up[1]).sum(axis=0) / 2e-4
    np.testing.assert_allclose(curvature, right.sum(axis=0), rtol=1e-4, atol=1e-4)


def test_a_patch_that_leaves_the_window_says_nothing(window):
    images, weights, corner, _ = window
    uv = np.array([[103.4, 215.0], [np.nan, 215.0], [120.0, 226.6]])
    information, score, gain = fits(images, weights, corner, uv, np.ones(3))
    assert not information.any()
    assert not score.any()
    assert gain == 0.0
    inside = np.array([[103.6, 215.0], [110.0, 215.0], [120.0, 225.4]])
    assert fits(images, weights, corner, inside, np.ones(3))[0].any(axis=(1, 2)).all()


def test_profiles_are_those_of_a_square_sampled_finely():
    shown = spot((41, 41), 20.3, 19.6, 6.0, grid=400)
    spread = Spread(2500.0 * 0.003 / 6.0, float(np.hypot(0.5, 5.47 * abs(1 / 6.0 - 1 / 20.0) / 4)))
    made = np.outer(spread.profile(np.arange(41) - 19.6), spread.profile(np.arange(41) - 20.3))
    np.testing.assert_allclose(made, shown, atol=1e-6)
    offsets = np.linspace(-4, 4, 33).reshape(3, 11)
    rise = spread.profile(offsets + 1e-6) - spread.profile(offsets - 1e-6)
    np.testing.assert_allclose(spread.profile_slope(offsets), rise / 2e-6, atol=1e-8)


def test_local_fits_join_to_one_over_state_and_fluxes():
    rng = np.random.default_rng(2)
    J, gain = rng.standard_normal((2, 4, 2, 10)), rng.uniform(0.5, 1.5, (2, 4, 2))
    root, score = rng.standard_normal((2, 4, 3, 3)), rng.standard_normal((2, 4, 3))
    information = root @ np.swapaxes(root, -1, -2)
    G = np.zeros((2, 4, 3, 12))
    G[..., 0, 10:], G[..., 1:, :10] = gain, J
    H, g = normal_equations_with_light(J, gain, information, score)
    np.testing.assert_allclose(H, np.einsum("cmas,cmab,cmbt->st", G, information, G), rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(g, np.einsum("cmas,cma->s", G, score), rtol=1e-12, atol=1e-12)


def test_frames_are_freed_of_what_a_basis_explains_by_least_squares():
    rng = np.random.default_rng(3)
    stack = rng.integers(380, 440, (5, 12, 17)).astype(np.uint16)
    mean, varies = mean_and_range(stack)
    np.testing.assert_allclose(mean, stack.mean(axis=0), rtol=1e-6)
    np.testing.assert_array_equal(varies, np.ptp(stack, axis=0))
    basis = rng.standard_normal((4, 12, 17)).astype(np.float32)
    counted = rng.random((12, 17)) < 0.8
    A, off = basis.reshape(4, -1).T.astype(float), (stack - mean).reshape(5, -1).T
    expected = np.linalg.lstsq(A[counted.ravel()], off[counted.ravel()], rcond=None)[0].T
    weighted = basis * counted.astype(np.float32)
    inverse = np.linalg.inv(A.T @ weighted.reshape(4, -1).T)
    found, rest, frames = equalised(stack, mean, basis, weighted, inverse.astype(np.float32), 15.0)
    left = off.T - expected @ A.T
    np.testing.assert_allclose(found, expected, rtol=1e-3, atol=1e-4)
    np.testing.assert_allclose(rest, np.sqrt(np.mean(np.clip(left, -15, 15) ** 2, axis=1)), rtol=1e-5)
    np.testing.assert_allclose(frames, left.reshape(stack.shape) + mean, rtol=1e-5)


@pytest.mark.parametrize("away_px", [0.0, -3.0, 4.0, -8.0, 9.0, -300.0, 300.0])
def test_a_pattern_is_scored_by_the_images_at_its_places_and_by_nothing_outside(away_px: float):
    snr = np.random.default_rng(4).standard_normal((2, 9, 11)).astype(np.float32)
    uv = np.array([[103.6 + away_px, 202.2], [109.2, 207.9 + away_px]])
    total = np.zeros((5, 7), dtype=np.float32)
    add_pattern(total, snr, 100, 200, uv, np.array([True, True]))
    for j, i in np.ndindex(total.shape):
        places = [(v + j - 202, u + i - 103) for u, v in np.rint(uv).astype(int)]
        inside = [(m, v, u) for m, (v, u) in enumerate(places) if 0 <= v < 9 and 0 <= u < 11]
        assert total[j, i] == pytest.approx(sum(snr[place] for place in inside), rel=1e-6)


def test_markers_that_are_not_used_add_nothing_to_the_best_place_of_a_pattern():
    snr = np.random.default_rng(5).standard_normal((2, 4, 30, 40)).astype(np.float32)
    uv = np.random.default_rng(6).uniform(5, 25, (6, 2, 4, 2))
    used, corners = np.array([True, False, True, True]), np.zeros((2, 2), dtype=np.int64)
    highest, shift = best_shifts((snr[0], snr[1]), corners, used, uv, 2, 3)
    for pattern, most, (row, column) in zip(uv, highest, shift, strict=True):
        total = np.zeros((5, 7), dtype=np.float32)
        for camera in (0, 1):
            dark = snr[camera] * used[:, None, None].astype(np.float32)
            add_pattern(total, dark, 0, 0, pattern[camera], np.ones(4, dtype=np.bool_))
        assert total[row + 2, column + 3] == total.max() == pytest.approx(most, rel=1e-6)
