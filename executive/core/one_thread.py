"""Linear algebra on one thread: several split their sums by the number of cores, and round otherwise on each
machine. A run must come out the same everywhere; it is no slower for it, as its matrices are small.
"""

from __future__ import annotations

from contextlib import AbstractContextManager

from threadpoolctl import threadpool_limits


def one_thread() -> AbstractContextManager[object]:
    """Until the end of the `with` block, in the whole process."""
    limits: AbstractContextManager[object] = threadpool_limits(limits=1, user_api="blas")
    return limits
