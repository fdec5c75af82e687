"""From expected electrons to counts: bloom, shot and read noise, saturation, quantisation."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sim_pybullet.radiometry import Exposure

Electrons = NDArray[np.float32]
Counts = NDArray[np.uint16]


class Sensor:
    """One sensor chip. Noise comes from the generator it is given; the same one gives the same counts."""

    def __init__(self, exposure: Exposure, rng: np.random.Generator) -> None:
        self.exposure = exposure
        self._rng = rng

    def expose(self, expected_e: Electrons, frames: int) -> Counts:
        """`frames` exposures of one expected image (h, w) [e-], as counts (frames, h, w)."""
        mean_e = bloomed(expected_e, self.exposure.full_well_e)
        noise = self._rng.standard_normal((frames, *mean_e.shape), dtype=np.float32)
        # Above a thousand electrons a Poisson count is a Gaussian to well below a quantisation step; a full
        # well holds what it holds, so only reading it out is noisy.
        shot_e2 = np.where(mean_e < self.exposure.full_well_e, mean_e, np.float32(0))
        noise *= np.sqrt(shot_e2 + np.float32(self.exposure.read_noise_e**2))
        noise += mean_e
        noise *= np.float32(1 / self.exposure.gain_e)
        noise += np.float32(0.5)
        np.clip(noise, 0, self.exposure.max_count, out=noise)
        return noise.astype(np.uint16)


def bloomed(expected_e: Electrons, full_well_e: float) -> Electrons:
    """Charge above the full well, spilt along its column, half up and half down, until it finds room.

    Charge that reaches the end of a column is lost. Returns the input itself where nothing overflows.
    """
    over = expected_e > full_well_e
    if not over.any():
        return expected_e
    columns = np.flatnonzero(over.any(axis=0))
    held = expected_e.copy()
    charge = held[:, columns]
    excess = np.maximum(charge - np.float32(full_well_e), 0)
    charge -= excess
    _spill(charge, excess / 2, full_well_e)
    _spill(charge[::-1], excess[::-1] / 2, full_well_e)
    held[:, columns] = charge
    return held


def _spill(charge: Electrons, excess: Electrons, full_well_e: float) -> None:
    """Carry the excess of each row downwards into the room of the rows below, in place."""
    carried = np.zeros(charge.shape[1], dtype=np.float32)
    for row, more in zip(charge, excess, strict=True):
        taken = np.minimum(carried, full_well_e - row)
        row += taken
        carried = carried - taken + more
