"""Expectations of a scenario, held against the result of its run."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from executive.config.models import Expect

Row = dict[str, object]


def judge(expect: Expect, result: Mapping[str, Any]) -> list[Row]:
    """One row per expectation: its text, whether it was met, and by how much (robustness, None if yes or no).

    A measure that the run does not have (no truth, never reached) does not meet its expectation.
    """
    return [*_of_outcome(expect, result), *_of_measures(expect, result), *_of_strategies(expect, result)]


def _of_outcome(expect: Expect, result: Mapping[str, Any]) -> Iterator[Row]:
    if expect.outcome is not None:
        yield _row(f"outcome is {expect.outcome}", result["outcome"] == expect.outcome)
    if expect.waypoints_reached is not None:
        margin = result["waypoints"]["reached"] - expect.waypoints_reached.at_least
        yield _row(f"at least {expect.waypoints_reached.at_least} way-points reached", margin >= 0, margin)
    if expect.diagnosed is not None:
        yield _diagnosed(expect, result)


def _of_measures(expect: Expect, result: Mapping[str, Any]) -> Iterator[Row]:
    truth = result["truth"]
    if expect.final_error is not None:
        limit = expect.final_error.below
        yield _below(f"final_error below {limit * 1e3:g} mm", truth["final_error_m"], limit)
    if expect.driven_beyond_off_track is not None:
        limit = expect.driven_beyond_off_track.below
        driven = truth["driven_beyond_off_track_m"]
        yield _below(f"driven_beyond_off_track below {limit * 1e3:g} mm", driven, limit)
    if expect.max_tilt is not None:
        limit_deg = expect.max_tilt.below * 57.29577951308232
        yield _below(f"max_tilt below {limit_deg:.3g} deg", truth["max_tilt_deg"], limit_deg)


def _of_strategies(expect: Expect, result: Mapping[str, Any]) -> Iterator[Row]:
    tried = {row["name"] for row in result["strategies"]}
    for name in expect.strategies_tried:
        yield _row(f"{name} was tried", name in tried)
    for name in expect.strategies_not_tried:
        yield _row(f"{name} was not tried", name not in tried)


def _diagnosed(expect: Expect, result: Mapping[str, Any]) -> Row:
    wanted = expect.diagnosed
    if wanted is None:
        raise ValueError("got no diagnosis to judge, expected one")
    text = f"{wanted.fault} diagnosed as {wanted.as_}"
    rows = [f for f in result["faults"] if f["name"] == wanted.fault and f["fired"]]
    if not rows or rows[0]["t_isolated_s"] is None or rows[0]["expected"] != wanted.as_:
        return _row(text, False)
    took = rows[0]["t_isolated_s"] - rows[0]["t_on_s"]
    if wanted.within is None:
        return _row(text, True)
    return _row(f"{text} within {wanted.within:g} s", took <= wanted.within, wanted.within - took)


def _below(text: str, value: float | None, limit: float) -> Row:
    if value is None:
        return _row(text, False)
    return _row(text, value < limit, limit - value)


def _row(text: str, met: bool, robustness: float | None = None) -> Row:
    return {"text": text, "met": met, "robustness": robustness}
