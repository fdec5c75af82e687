"""Sums of floats that are the same to the last bit in every version of Python."""

from __future__ import annotations

from collections.abc import Iterable
from functools import reduce
from operator import add


def ordered_sum(values: Iterable[float]) -> float:
    """Their sum, rounded after each addition, from left to right; 0.0 for none.

    The built-in `sum` does so up to Python 3.11. From 3.12 on it carries the rounding errors along, so that
    the record of a run would differ in its last bits. Meant for whatever reaches a record.
    """
    return reduce(add, values, 0.0)
