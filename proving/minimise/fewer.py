"""Delta debugging: the smallest part of a list that still does it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeVar

T = TypeVar("T")


def fewer(items: Sequence[T], still: Callable[[list[T]], bool], least: int = 0) -> list[T]:
    """A part of `items`, in their order, for which `still` holds and without any one item no longer does.

    It must hold for all of them. Half is left out first, then quarters, down to single items.
    """
    kept, size = list(items), max(1, len(items) - least)
    while size and len(kept) > least:
        before, start = len(kept), 0
        while start < len(kept):
            rest = kept[:start] + kept[start + size :]
            if len(rest) >= least and still(rest):
                kept = rest
            else:
                start += size
        if size > 1 or len(kept) == before:
            size //= 2
    return kept
