"""Which faults may provoke which outcome; those that are not installed are passed over."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from executive.core.types import Reason
from executive.pool import Strategy
from executive.run import FaultSpec, every_fault
from proving.coverage.items import Item

Fault = dict[str, Any]
"""A fault's kind with its parameters, as a scenario has it."""

RECIPES: dict[str, tuple[Fault, ...]] = {
    "not_seen": ({"frozen_frame": {}}, {"camera_dead": {"camera": "left"}}, {"pan_locked": {}}),
    "poor_view": (
        {"image_blur": {"sigma": 6.0}},
        {"led_off": {"markers": [0, 1]}},
        {"marker_occluded": {"marker": 0}},
    ),
    "unstable_images": ({"cloud": {}}, {"head_vibration": {"amplitude": "0.2 deg"}}, {"glare": {}}),
    "implausible": ({"pose_outlier": {"x": "1 m"}}, {"pose_nan": {}}, {"led_swapped": {}}),
    "timeout": ({"late_frame": {"by": "30 min"}}, {"motor_dead": {"side": "left"}}),
    "device": ({"missing_frame": {}}, {"pan_locked": {}}, {"motor_dead": {"side": "left"}}),
    "blocked": (
        {"track_jam": {"side": "left"}},
        {"cabin_locked": {}},
        {"arm_locked": {}},
        {"rock_on_path": {"ahead": "0.3 m"}},
        {"spool_jam": {}},
    ),
    "tilt": ({"inclinometer_bias": {"pitch": "30 deg"}}, {"wrong_elevation_model": {"height": "8 cm"}}),
    "off_track": ({"pose_outlier": {"x": "0 m", "y": "0.4 m"}}, {"side_slope_drift": {"drift": 0.5}}),
    "off_heading": ({"low_friction_patch": {}}, {"slip_burst": {}}, {"motor_reversed": {"side": "left"}}),
    "overshoot": (
        {"encoder_lost_counts": {"side": "left", "share": "50 %"}},
        {"pose_outlier": {"x": "0.2 m"}},
    ),
    "unexpected": ({"slip_burst": {"slip": "70 %"}}, {"track_weak": {"side": "left"}}, {"pose_outlier": {}}),
    "guard": ({"pose_outlier": {"x": "0 m", "y": "0.4 m"}}, {"missing_frame": {}}),
    "halted": ({"track_jam": {"side": "left"}}, {"inclinometer_bias": {"pitch": "30 deg"}}),
    "no_strategy": ({"frozen_frame": {}}, {"missing_frame": {}}),
    "failure": ({"frozen_frame": {}}, {"track_jam": {"side": "left"}}, {"missing_frame": {}}),
    "running": ({"slip_burst": {}}, {"pose_outlier": {}}),
    "success": ({"slip_burst": {}}, {"pose_outlier": {}}),
}
NEEDED: Fault = {"side": "left", "camera": "left", "value": "pose", "marker": 0}
"""What a fault is given that must be told something."""


def at_node(word: str, node: str) -> Iterator[Fault]:
    """What may make a node end like this; to force it comes last, as it proves least."""
    yield from RECIPES.get(word, ())
    if word in ("success", "failure"):
        yield {"node_forced": {"node": node, "status": word}}
    elif word in {str(reason) for reason in Reason}:
        yield {"node_forced": {"node": node, "status": "failure", "reason": word}}


def for_strategy(strategy: Strategy) -> Iterator[Fault]:
    """What should lead the pool to this strategy: by the reasons it answers, then by the hypotheses."""
    for reason, _ in sorted(strategy.reasons.items(), key=lambda pair: -pair[1]):
        yield from RECIPES.get(str(reason), ())
    for hypothesis, _ in sorted(strategy.answers.items(), key=lambda pair: -pair[1]):
        yield from for_hypothesis(str(hypothesis))


def for_hypothesis(hypothesis: str) -> Iterator[Fault]:
    """The faults that should be diagnosed as this."""
    for spec in specs():
        if spec.hypothesis == hypothesis:
            yield from of_kind(spec, ())


def of_kind(spec: FaultSpec, strategies: Iterable[str]) -> Iterator[Fault]:
    """The fault itself, with what it must be told."""
    required = [name for name, field in spec.model.model_fields.items() if field.is_required()]
    if spec.strategy in required:
        yield from ({spec.name: {spec.strategy: name}} for name in strategies)
    elif spec.node in required:
        yield {spec.name: {spec.node: "localise"}}
    elif set(required) <= NEEDED.keys():
        wanted = [*required, *({"marker"} & spec.model.model_fields.keys())]
        yield {spec.name: {name: NEEDED[name] for name in wanted}}


def specs() -> list[FaultSpec]:
    """Every kind of fault that is installed."""
    return list(every_fault())


def for_item(item: Item, strategies: dict[str, Strategy]) -> Iterator[Fault]:
    """What may show an item that is no node."""
    match item.kind:
        case "strategy":
            yield from for_strategy(strategies[item.name])
        case "hypothesis":
            yield from for_hypothesis(item.name)
        case "fault":
            for spec in specs():
                if spec.name == item.name:
                    yield from of_kind(spec, strategies)
        case "phase":
            yield from RECIPES["no_strategy"]
