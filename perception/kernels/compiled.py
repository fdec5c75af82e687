"""Python functions compiled to machine code by numba, kept on disk from one process to the next."""

from __future__ import annotations

import contextlib
import hashlib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

import numpy as np
from numba import njit
from numba.core.caching import FunctionCache, IndexDataCacheFile
from numpy.typing import ArrayLike

from executive.types import Array

Function = TypeVar("Function", bound=Callable[..., object])


def compiled(function: Function) -> Function:
    """The function in machine code, made at its first call.

    Rounds as Python does, without the freedoms that make sums differ from machine to machine; division by
    zero gives an infinity, as with arrays. Where nothing can be written it is compiled anew in each process.
    """
    made: Any = njit(error_model="numpy")(function)
    with contextlib.suppress(RuntimeError):  # no folder to keep it in
        made._cache = _Kept(function)
    return cast(Function, made)


class _Kept(FunctionCache):
    """Goes stale with any file of the function's folder: numba looks at the function's own file alone, and
    would go on calling what another file said before."""

    def __init__(self, function: Callable[..., object]) -> None:
        super().__init__(function)  # type: ignore[no-untyped-call]  # numba has no types
        stamp = _sources(Path(function.__code__.co_filename).parent)
        base = self._impl.filename_base
        self._cache_file = IndexDataCacheFile(self.cache_path, base, stamp)  # type: ignore[no-untyped-call]  # numba has no types


@cache
def _sources(folder: Path) -> str:
    digest = hashlib.sha256()
    for file in sorted(folder.glob("*.py")):
        digest.update(file.read_bytes())
    return digest.hexdigest()


def plain(values: ArrayLike) -> Array:
    """A C-contiguous, writable float64 copy, the one kind of array that kernels are compiled for."""
    return np.array(values, dtype=np.float64, order="C")
