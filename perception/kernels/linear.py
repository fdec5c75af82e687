"""Small positive definite systems by Cholesky's method, without the cost of a call to LAPACK."""

from __future__ import annotations

import math

import numpy as np

from executive.core.types import Array
from perception.kernels.compiled import compiled


@compiled
def factor(A: Array) -> None:
    """Cholesky factor of a positive definite matrix, in its lower half; NaN where it is not one."""
    for j in range(len(A)):
        for i in range(j, len(A)):
            rest = A[i, j]
            for k in range(j):
                rest -= A[i, k] * A[j, k]
            if i > j:
                A[i, j] = rest / A[j, j]
            else:
                A[j, j] = math.sqrt(rest) if rest > 0 else math.nan


@compiled
def solve(L: Array, b: Array) -> None:
    """Solve L L^T x = b in place."""
    n = len(b)
    for i in range(n):
        for k in range(i):
            b[i] -= L[i, k] * b[k]
        b[i] /= L[i, i]
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            b[i] -= L[k, i] * b[k]
        b[i] /= L[i, i]


@compiled
def inverted(A: Array, size: int) -> Array:
    """The first rows and columns (size, size) of the inverse of a positive definite matrix, else NaN."""
    L, out, column = A.copy(), np.empty((size, size)), np.empty(len(A))
    factor(L)
    for j in range(size):
        for i in range(len(A)):
            column[i] = 1.0 if i == j else 0.0
        solve(L, column)
        for i in range(j, size):
            out[i, j] = out[j, i] = column[i]
    return out
