"""The explanation for people: plain text, one idea a block, times as mission time."""

from __future__ import annotations

import math
from collections.abc import Iterator

from executive.record.events import Command
from executive.record.run_result import FaultStages
from executive.report.explain.chain import Chain, ChainLink
from executive.report.explain.explanation import Explanation
from executive.report.figure import duration

MARKS = {"success": "✓", "failure": "✗", "running": "▶", "invalid": "·"}
_LEAST_WEIGHT, _MOST_VALUES, _BAR = 0.01, 4, 20
_UNITS = {"_m_s": "m/s", "_m": "m", "_s": "s", "_rad": "rad", "_n": "N"}


def as_text(found: Explanation) -> str:
    """The whole explanation; blocks without content say so or are left out."""
    blocks = [
        list(_head(found)),
        ["What it was doing, from the leaf to the root:", *_chain(found.chain)],
        list(_failure(found)),
        list(_hypotheses(found)),
        ["What was tried, and why:", *(_strategies(found) or ["  nothing"])],
        _titled("What the pool refused:", [f"  {_t(t)}  {why}" for t, why in found.refusals]),
        _titled(
            "Calls to ground:", [f"  {_t(t)}  {call.reason.value}: {call.detail}" for t, call in found.calls]
        ),
        _titled("Last commands:", [f"  {_t(t)}  {_command(command)}" for t, command in found.commands]),
        _titled("Injected faults that had taken effect:", [_fault(row) for row in found.faults]),
    ]
    return "\n\n".join("\n".join(block) for block in blocks if block) + "\n"


def _titled(title: str, lines: list[str]) -> list[str]:
    return [title, *lines] if lines else []


def _t(seconds: float) -> str:
    return duration(seconds).replace("\u00a0", " ").rjust(12)


def _head(found: Explanation) -> Iterator[str]:
    seed = "" if found.seed is None else f", seed {found.seed}"
    end = found.outcome or "the record was cut off"
    yield f"{found.scenario}{seed}: {end} after {_t(found.end_s).strip()}"
    yield f"  {found.sentence}".replace("\u00a0", " ")
    if found.reason:
        yield f"  {found.reason}"
    yield f"At {_t(found.at_s).strip()} of mission time ({found.at_s:g} s)" + _place(found)


def _place(found: Explanation) -> str:
    pose = found.pose
    if pose is None:
        return ""
    heading_deg, sigma_mm = math.degrees(pose.heading_rad), pose.sigma_position_m * 1000
    return (
        f", believed at x {pose.x_m:.3f} m, y {pose.y_m:.3f} m, heading {heading_deg:.1f} deg "
        f"(±{sigma_mm:.1f} mm, by {pose.source})"
    )


def _chain(chain: Chain) -> list[str]:
    if not chain:
        return ["  nothing had been ticked"]
    width = max(len(link.name) for link in chain)
    return [f"  {_node(link, width)}" for link in chain]


def _node(link: ChainLink, width: int) -> str:
    why = ": ".join(word for word in (link.reason, link.detail) if word)
    said = f"{MARKS.get(link.status, '?')} {link.name:{width}}  {link.status:8} since {_t(link.since_s)}"
    return f"{said}  {why}".rstrip()


def _failure(found: Explanation) -> Iterator[str]:
    """The last failure that meant something, beside what the first block shows."""
    if found.failure:
        yield "What had failed last, from the leaf to the root, as it was then:"
        yield from _chain(found.failure)


def _hypotheses(found: Explanation) -> Iterator[str]:
    if found.weighed_s is None:
        yield "Hypotheses: none had been weighed"
        return
    yield f"Hypotheses, as weighed at {_t(found.weighed_s).strip()}:"
    likely = {name: weight for name, weight in found.hypotheses.items() if weight >= _LEAST_WEIGHT}
    width = max((len(name) for name in likely), default=0)
    for name, weight in likely.items():
        yield f"  {weight:4.2f}  {name:{width}}  {'#' * max(1, round(weight * _BAR))}"
    rest = sum(found.hypotheses.values()) - sum(likely.values())
    if rest > 0:
        yield f"  {rest:4.2f}  all others together"
    if found.time_to_margin_s is not None:
        left = _t(found.time_to_margin_s).strip()
        yield f"  going on like this, the off-track margin would be crossed in {left}"


def _strategies(found: Explanation) -> list[str]:
    words = {True: "helped", False: "did not help", None: "verdict still out"}
    return [
        f"  {_t(row.t_s)}  {row.name}, attempt {row.attempt}, against {row.hypothesis} "
        f"at {row.weight:.2f}: {row.why}; {words[row.helped]}"
        for row in found.strategies
    ]


def _command(command: Command) -> str:
    values = [_value(name, value) for name, value in list(command.values.items())[:_MOST_VALUES]]
    more = ", …" if len(command.values) > _MOST_VALUES else ""
    return f"{command.device} {command.verb}" + (f": {', '.join(values)}{more}" if values else "")


def _value(name: str, value: float) -> str:
    for suffix, unit in _UNITS.items():
        if name.endswith(suffix):
            shown, unit = (math.degrees(value), "deg") if unit == "rad" else (value, unit)
            return f"{name.removesuffix(suffix)} {shown:.4g} {unit}"
    return f"{name} {value:.4g}"


def _fault(fault: FaultStages) -> str:
    until = "still active" if fault.t_off_s is None else f"until {_t(fault.t_off_s).strip()}"
    expected = f"; expected diagnosis {fault.expected}" if fault.expected else ""
    return f"  {_t(fault.t_on_s or 0.0)}  {fault.name}: {until}{expected}"
