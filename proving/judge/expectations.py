"""Expectations of a scenario, held against its run: a row for each, with how much was to spare."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

from executive.config.validate import listed
from executive.record import DETECTION_GRACE_S, FaultStages, History, JudgedRow, RunResult, first_leading, row
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


def judge(expect: Expect, result: RunResult, history: History, world: History) -> list[JudgedRow]:
    """One row per expectation.

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


def _of_the_end(expect: Expect, result: RunResult, history: History, world: History) -> Iterator[JudgedRow]:
    end_s = result.mission_s
    if expect.outcome:
        met = result.outcome in expect.outcome
        yield row(f"outcome is {listed(expect.outcome)}", met, t_violation_s=end_s)
    if expect.waypoints_reached is not None:
        spare = result.waypoints.reached - expect.waypoints_reached.at_least
        text = f"at least {expect.waypoints_reached.at_least} way-points reached"
        yield row(text, spare >= 0, spare, "", end_s)
    if expect.mission_time is not None:
        yield _within("mission_time", expect.mission_time, end_s, "s", end_s)
    if expect.path is not None:
        yield _within("path", expect.path, result.truth.path_m, "m", end_s)
    if expect.final_error is not None:
        limit_m, error_m = expect.final_error.below, result.truth.final_error_m
        text = f"final_error below {limit_m * 1e3:g} mm"
        if error_m is None:
            yield row(text, False, t_violation_s=end_s, warning=NO_TRUTH)
        else:
            yield row(text, error_m < limit_m, limit_m - error_m, "m", end_s)
    if expect.at_rest:
        yield _known(at_rest(history, world), end_s)


def _within(
    name: str, band: LengthBand | DurationBand, value: float | None, unit: str, end_s: float
) -> JudgedRow:
    """Whether a value lies between its bounds; what is not known does not."""
    bounds = [(word, limit) for word in ("above", "below") if (limit := getattr(band, word)) is not None]
    text = f"{name} {' and '.join(f'{word} {limit:g} {unit}' for word, limit in bounds)}"
    if value is None:
        return row(text, False, t_violation_s=end_s, warning=NO_TRUTH)
    spare = min(value - limit if word == "above" else limit - value for word, limit in bounds)
    return row(text, spare > 0, spare, unit, end_s)


def _of_limits(expect: Expect, history: History, world: History) -> Iterator[JudgedRow]:
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


def _known(found: JudgedRow, end_s: float) -> JudgedRow:
    """Of an expectation, what is not known is not met."""
    return found if found.met is not None else replace(found, met=False, t_violation_s=end_s)


def _of_faults(expect: Expect, result: RunResult, history: History) -> Iterator[JudgedRow]:
    faults = {fault.name: fault for fault in result.faults}
    for noticed in expect.detected:
        fault = faults.get(noticed.fault, FaultStages(noticed.fault))
        yield _in_time(noticed, f"{noticed.fault} detected", fault, fault.t_detected_s, history)
    for diagnosed in expect.diagnosed:
        fault = faults.get(diagnosed.fault, FaultStages(diagnosed.fault))
        yield _diagnosed(diagnosed, fault, history)
    for noticed in expect.recovered:
        fault = faults.get(noticed.fault, FaultStages(noticed.fault))
        yield _in_time(noticed, f"recovered from {noticed.fault}", fault, fault.t_recovered_s, history)


def _diagnosed(wanted: Diagnosed, fault: FaultStages, history: History) -> JudgedRow:
    on_s, off_s = fault.t_on_s, fault.t_off_s
    until_s = math.inf if off_s is None else off_s + DETECTION_GRACE_S
    led_s = None if on_s is None else first_leading(history, wanted.as_, on_s, until_s)
    return _in_time(wanted, f"{wanted.fault} diagnosed as {wanted.as_}", fault, led_s, history)


def _in_time(
    noticed: Noticed, text: str, fault: FaultStages, at_s: float | None, history: History
) -> JudgedRow:
    """Whether a stage came in time after the fault took effect; the time left is the robustness [s]."""
    on_s, within_s = fault.t_on_s, noticed.within
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


def _of_strategies(expect: Expect, result: RunResult) -> Iterator[JudgedRow]:
    tried_s: dict[str, float] = {}
    for strategy in result.strategies:
        tried_s.setdefault(strategy.name, strategy.t_s)
    for name in expect.strategies_tried:
        yield row(f"{name} was tried", name in tried_s, t_violation_s=result.mission_s)
    for name in expect.strategies_not_tried:
        yield row(f"{name} was not tried", name not in tried_s, t_violation_s=tried_s.get(name))


def _of_nodes(expect: Expect, history: History) -> Iterator[JudgedRow]:
    seen = ends(history)
    yield from in_order(expect.in_order, seen, history.end_s)
    yield from never(expect.never, seen)
    yield from times(expect.times, seen, history.end_s)


def _of_signals(expect: Expect, history: History, world: History) -> Iterator[JudgedRow]:
    for text, formula in formulas(expect):
        found = judge_formula(formula, recorded(names(formula), history, world))
        violated_s = history.end_s if found.violated_s is None else found.violated_s
        yield row(text, found.met, found.robustness, found.unit, violated_s, found.warning)
