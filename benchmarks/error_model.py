"""Measures the table in `sim_pybullet/error_model.py`: the full tier's marker error over filter SNR.

Simulated on/off sequences of one marker (sunlit ground, random sub-pixel place) go through the detector of
the perception package. Run from the project's root: `python -m benchmarks.error_model`.
"""

from __future__ import annotations

import math

import numpy as np

from executive.core.rig import RigCalibration
from executive.core.types import Window
from perception.frames.difference import difference, led_sequence
from perception.frames.psf import marker_spread
from perception.markers.centres import find_markers
from sim_pybullet.error_model import centre_error
from sim_pybullet.leds import Spot, add_spot
from sim_pybullet.radiometry import Exposure, spread_sigma_px
from sim_pybullet.sensor import Sensor

_RIG = RigCalibration()
_WINDOW = Window(0, 0, 96, 96)
_PAIRS = 4
_SNRS = (2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 10.0, 15.0, 30.0, 100.0)
_RANGES_M = (2.0, 4.0, 8.0)


def sequence(leds: tuple[int, ...], spot: Spot, rng: np.random.Generator) -> np.ndarray:
    """Counts (frames, h, w) of a sequence in which marker 0 is the only one there is."""
    exposure = Exposure(_RIG.sensor.bits)
    sensor = Sensor(exposure, rng)
    unlit = np.full((_WINDOW.height, _WINDOW.width), exposure.ground_e, dtype=np.float32)
    lit = unlit.copy()
    add_spot(lit, spot, _WINDOW)
    counts = sensor.expose(unlit, len(leds))
    on = [i for i, mask in enumerate(leds) if mask & 1]
    counts[on] = sensor.expose(lit, len(on))
    return counts


def measure(
    snr: float, range_m: float, trials: int, rng: np.random.Generator
) -> tuple[float, float, float, float]:
    """Share found, RMS error over the bound, mean NEES (2 expected), share of false centres."""
    exposure, spread = Exposure(_RIG.sensor.bits), marker_spread(_RIG, range_m)
    leds = led_sequence(4, _PAIRS)
    size_px = _RIG.cameras[0].focal_px * _RIG.markers.size_m / range_m
    blur_px = spread_sigma_px(_RIG.sensor, range_m)
    found, false, excess, nees = 0, 0, [], []
    for _ in range(trials):
        u, v = 48 + rng.uniform(-0.5, 0.5, 2)
        unit = Spot(u, v, size_px, blur_px, 1.0)
        spot = Spot(u, v, size_px, blur_px, snr / centre_error(unit, exposure, _PAIRS, _PAIRS).snr)
        expected = centre_error(spot, exposure, _PAIRS, _PAIRS, factor=1.0)
        frames = sequence(leds, spot, rng).astype(np.float32)
        d = difference(frames, leds, 4, exposure.noise_counts)
        best = find_markers(d.images[0], d.sigma[0], spread)[:1]
        if not best:
            continue
        error = best[0].uv_px - (u, v)
        if np.hypot(*error) > 4:
            false += 1
            continue
        found += 1
        excess.append((error[0] / expected.sigma_u_px) ** 2 / 2 + (error[1] / expected.sigma_v_px) ** 2 / 2)
        nees.append(error @ np.linalg.solve(best[0].covariance_px2, error))
    rms = math.sqrt(np.mean(excess)) if excess else math.nan
    return found / trials, rms, float(np.mean(nees)) if nees else math.nan, false / trials


def main(trials: int = 150) -> None:
    rng = np.random.default_rng(11)
    print("  SNR  found  error/bound  NEES  false   (per range: error/bound)")
    for snr in _SNRS:
        each = np.array([measure(snr, range_m, trials, rng) for range_m in _RANGES_M])
        found, _, nees, false = np.nanmean(each, axis=0)
        weights = np.where(np.isfinite(each[:, 1]), each[:, 0], 0)
        rms = math.sqrt(np.nansum(weights * each[:, 1] ** 2) / max(weights.sum(), 1e-9))
        per_range = " ".join(f"{x:.2f}" for x in each[:, 1])
        print(f"{snr:5.0f}  {found:5.3f}  {rms:11.2f}  {nees:4.2f}  {false:5.3f}   ({per_range})")


if __name__ == "__main__":
    main()
