"""Expectations of a scenario, held against its run: a row for each, with how much was to spare."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

from executive.config.validate import listed
from executive.record.evidence import DETECTION_GRACE_S, first_leading
from executive.record.history import History
from executive.record.rows import Row, row
from proving.judge.expect import Diagnosed, DurationBand, Expect, LengthBand, Noticed
from proving.judge.expected import formulas
from proving.judge.node_ends import (
    ends,
    in_order,
    never,
    times,
)
from proving.judge.temporal import judge as judge_formula
from proving.judge.temporal import names, recorded
from proving.judge.true_measures import (
    CROSS_TRACK,
    DRIVEN_BEYOND,
    NO_TRUTH,
    TETHER,
    TILT,
    Measure,
    at_rest,
    below,
)


def judge(expect: Expect, result: Mapping[str, Any], history: History, world: History) -> list[Row]:
    """One row per expectation, as `executive.record.rows.row` makes them.

    A measure that the run does not have (no truth, never reached) does not meet its expectation.
    """
    return [
        *_of_the_end(expect, result, history, world),
        *_of_limits(expect, history, world),
        *_of_faults(expect, result, history),
        *_of_strategies(expect, result),
        *_of_nodes(expect, history),
        *_of_signals(expect, history, world),
    ]


def _of_the_end(expect: Expect, result: Mapping[str, Any], history: History, world: History) -> Iterator[Row]:
    end_s = result["mission_s"]
    if expect.outcome:
        met = result["outcome"] in expect.outcome
        yield row(f"outcome is {listed(expect.outcome)}", met, t_violation_s=end_s)
    if expect.waypoints_reached is not None:
        spare = result["waypoints"]["reached"] - expect.waypoints_reached.at_least
        text = f"at least {expect.waypoints_reached.at_least} way-points reached"
        yield row(text, spare >= 0, spare, "", end_s)
    if expect.mission_time is not None:
        yield _within("mission_time", expect.mission_time, end_s, "s", end_s)
    if expect.path is not None:
        yield _within("path", expect.path, result["truth"]["path_m"], "m", end_s)
    if expect.final_error is not None:
        limit_m, error_m = expect.final_error.below, result["truth"]["final_error_m"]
        text = f"final_error below {limit_m * 1e3:g} mm"
        if error_m is None:
            yield row(text, False, t_violation_s=end_s, warning=NO_TRUTH)
        else:
            yield row(text, error_m < limit_m, limit_m - error_m, "m", end_s)
    if expect.at_rest:
        yield _known(at_rest(history, world), end_s)


def _within(name: str, band: LengthBand | DurationBand, value: float | None, unit: str, end_s: float) -> Row:
    """Whether a value lies between its bounds; what is not known does not."""
    bounds = [(word, limit) for word in ("above", "below") if (limit := getattr(band, word)) is not None]
    text = f"{name} {' and '.join(f'{word} {limit:g} {unit}' for word, limit in bounds)}"
    if value is None:
        return row(text, False, t_violation_s=end_s, warning=NO_TRUTH)
    spare = min(value - limit if word == "above" else limit - value for word, limit in bounds)
    return row(text, spare > 0, spare, unit, end_s)


def _of_limits(expect: Expect, history: History, world: History) -> Iterator[Row]:
    limits: list[tuple[str, Measure, float]] = []
    if expect.driven_beyond_off_track is not None:
        limits.append(("driven_beyond_off_track", DRIVEN_BEYOND, expect.driven_beyond_off_track.below))
    if expect.max_cross_track is not None:
        limits.append(("max_cross_track", CROSS_TRACK, expect.max_cross_track.below))
    if expect.max_tilt is not None:
        limits.append(("max_tilt", TILT, math.degrees(expect.max_tilt.below)))
    if expect.max_tether is not None:
        limits.append(("max_tether", TETHER, expect.max_tether.below))
    for name, measure, limit in limits:
        shown = f"{limit * 1e3:g} mm" if measure.unit == "m" else f"{limit:.4g} {measure.unit}"
        yield _known(below(f"{name} below {shown}", measure, limit, history, world), history.end_s)


def _known(found: Row, end_s: float) -> Row:
    """Of an expectation, what is not known is not met."""
    return found if found["met"] is not None else found | {"met": False, "t_violation_s": end_s}


def _of_faults(expect: Expect, result: Mapping[str, Any], history: History) -> Iterator[Row]:
    faults = {fault["name"]: fault for fault in result["faults"]}
    for noticed in expect.detected:
        yield _in_time(noticed, f"{noticed.fault} detected", faults, "t_detected_s", history)
    for diagnosed in expect.diagnosed:
        yield _diagnosed(diagnosed, faults, history)
    for noticed in expect.recovered:
        yield _in_time(noticed, f"recovered from {noticed.fault}", faults, "t_recovered_s", history)


def _diagnosed(wanted: Diagnosed, faults: Mapping[str, Any], history: History) -> Row:
    fault = faults.get(wanted.fault, {})
    on_s, off_s = fault.get("t_on_s"), fault.get("t_off_s")
    until_s = math.inf if off_s is None else off_s + DETECTION_GRACE_S
    led_s = None if on_s is None else first_leading(history, wanted.as_, on_s, until_s)
    text = f"{wanted.fault} diagnosed as {wanted.as_}"
    return _in_time(wanted, text, {wanted.fault: fault | {"t_s": led_s}}, "t_s", history)


def _in_time(noticed: Noticed, text: str, faults: Mapping[str, Any], stage: str, history: History) -> Row:
    """Whether a fault reached a stage in time after it took effect; the time left is the robustness [s]."""
    fault, within_s = faults.get(noticed.fault, {}), noticed.within
    on_s, at_s = fault.get("t_on_s"), fault.get(stage)
    if within_s is not None:
        text = f"{text} within {within_s:g} s"
    if on_s is None:
        return row(text, False, t_violation_s=history.end_s, warning=f"{noticed.fault} never took effect")
    due_s = history.end_s if within_s is None else min(on_s + within_s, history.end_s)
    if at_s is None:
        return row(text, False, t_violation_s=due_s)
    if within_s is None:
        return row(text, True)
    spare_s = on_s + within_s - at_s
    return row(text, spare_s >= 0, spare_s, "s", due_s)


def _of_strategies(expect: Expect, result: Mapping[str, Any]) -> Iterator[Row]:
    tried_s: dict[str, float] = {}
    for strategy in result["strategies"]:
        tried_s.setdefault(strategy["name"], strategy["t_s"])
    for name in expect.strategies_tried:
        yield row(f"{name} was tried", name in tried_s, t_violation_s=result["mission_s"])
    for name in expect.strategies_not_tried:
        yield row(f"{name} was not tried", name not in tried_s, t_violation_s=tried_s.get(name))


def _of_nodes(expect: Expect, history: History) -> Iterator[Row]:
    seen = ends(history)
    yield from in_order(expect.in_order, seen, history.end_s)
    yield from never(expect.never, seen)
    yield from times(expect.times, seen, history.end_s)


def _of_signals(expect: Expect, history: History, world: History) -> Iterator[Row]:
    for text, formula in formulas(expect):
        found = judge_formula(formula, recorded(names(formula), history, world))
        violated_s = history.end_s if found.violated_s is None else found.violated_s
        yield row(text, found.met, found.robustness, found.unit, violated_s, found.warning)
