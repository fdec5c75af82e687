"""PyBullet, imported without the line it writes to the process's standard error."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def quiet() -> Iterator[None]:
    """C code writes to the descriptors themselves, so the descriptors are what must be moved."""
    sys.stdout.flush()
    sys.stderr.flush()
    kept = os.dup(1), os.dup(2)
    try:
        with open(os.devnull, "wb") as nowhere:
            os.dup2(nowhere.fileno(), 1)
            os.dup2(nowhere.fileno(), 2)
            yield
    finally:
        for number, descriptor in enumerate(kept, 1):
            os.dup2(descriptor, number)
            os.close(descriptor)


with quiet():
    import pybullet
    import pybullet_data

HUSKY = os.path.join(pybullet_data.getDataPath(), "husky", "husky.urdf")

__all__ = ["HUSKY", "pybullet", "quiet"]
