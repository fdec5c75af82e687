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
from numba.core import caching
from numpy.typing import ArrayLike

from executive.core.types import Array

Function = TypeVar("Function", bound=Callable[..., object])
_KERNELS: list[Any] = []


def compiled(function: Function) -> Function:
    """The function in machine code, made at its first call.

    Rounds as Python does, without the freedoms that make sums differ from machine to machine; division by
    zero gives an infinity, as with arrays. Where nothing can be written it is compiled anew in each process.
    """
    made: Any = njit(error_model="numpy")(function)
    with contextlib.suppress(RuntimeError):  # no folder to keep it in
        made._cache = _cache_of(function)
    _KERNELS.append(made)
    return cast(Function, made)


def uncompiled() -> list[str]:
    """The kernels imported so far whose machine code, as the sources are now, is not on disk."""
    return [kernel.__name__ for kernel in _KERNELS if not kernel.signatures and not _on_disk(kernel)]


def _on_disk(kernel: Any) -> bool:
    index = getattr(kernel._cache, "_cache_file", None)
    return index is not None and bool(index._load_index())


def _cache_of(function: Callable[..., object]) -> Any:
    """Named by all files of the function's folder. Numba looks at the function's own file alone: it would go
    on calling what another file said before, and fail on reading types that are no longer there."""
    numba: Any = caching  # which has no types
    cache = numba.FunctionCache(function)
    stamp = _sources(Path(function.__code__.co_filename).parent)
    name = f"{cache._impl.filename_base}-{stamp[:16]}"
    cache._cache_file = numba.IndexDataCacheFile(cache.cache_path, name, stamp)
    return cache


@cache
def _sources(folder: Path) -> str:
    digest = hashlib.sha256()
    for file in sorted(folder.glob("*.py")):
        digest.update(file.read_bytes())
    return digest.hexdigest()


def plain(values: ArrayLike) -> Array:
    """A C-contiguous, writable float64 copy, the one kind of array that kernels are compiled for."""
    return np.array(values, dtype=np.float64, order="C")
