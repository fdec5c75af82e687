"""Chance: one generator per component, from (seed, name), so that adding one does not shift the others."""

from __future__ import annotations

from zlib import crc32

import numpy as np


def generator(seed: int, name: str) -> np.random.Generator:
    """The generator of the component `name` in a run with this seed."""
    return np.random.default_rng([seed, crc32(name.encode())])
