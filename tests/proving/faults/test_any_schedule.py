"""Whatever faults come together, whenever: the rover rests at the end, and the record ends with a stop."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from executive.core import registry
from executive.run.fault import FAULT_KIND, FaultSpec
from tests.proving.faults.scenario import run

OUTCOMES = {"reached", "safe_hold", "help", "time_limit", "invalid", "error"}
SIDES = st.sampled_from(["left", "right"])
NODE = st.sampled_from(["localise", "drive_leg", "turn_towards", "facing", "watch_motion", "recover", "loop"])
STRATEGY = st.sampled_from(["wait_for_sight", "fresh_look", "cabin_reposing", "back_off"])
AT = st.sampled_from(["before", "after"])


def share(low: float, high: float) -> st.SearchStrategy[str]:
    return st.floats(low, high).map(lambda value: f"{value:.3f}")


def of(low: float, high: float, unit: str) -> st.SearchStrategy[str]:
    return st.floats(low, high).map(lambda value: f"{value:.3f} {unit}")


PARAMETERS: dict[str, dict[str, st.SearchStrategy[Any]]] = {
    "encoder_scale": {"side": SIDES, "factor": share(0.5, 2.0)},
    "encoder_stuck": {"side": SIDES},
    "encoder_lost_counts": {"side": SIDES, "share": share(0.01, 0.9)},
    "currents_garbage": {"side": SIDES},
    "head_encoder_offset": {"pan": of(-20, 20, "deg")},
    "camera_dead": {"camera": SIDES},
    "frozen_frame": {},
    "late_frame": {"by": of(1, 1000, "s")},
    "missing_frame": {},
    "swapped_cameras": {},
    "exposure_off": {"factor": share(0.01, 4.0)},
    "hot_pixels": {"count": st.integers(1, 1000)},
    "calibration_drift": {"camera": SIDES, "u": st.floats(-100, 100), "v": st.floats(-100, 100)},
    "pose_outlier": {"x": of(-1, 1, "m"), "y": of(-1, 1, "m")},
    "pose_nan": {},
    "pose_stale": {"restamped": st.booleans()},
    "inclinometer_bias": {"pitch": of(-0.7, 0.7, "rad")},
    "link_delay": {"by": of(1, 1000, "s")},
    "link_drop": {},
    "link_outage": {},
    "link_duplicate": {},
    "link_corrupt": {},
    "replayed_uplink": {},
    "node_forced": {"node": NODE, "status": st.sampled_from(["success", "failure", "running"]), "at": AT},
    "node_hangs": {"node": NODE},
    "node_raises": {"node": NODE, "at": AT},
    "late_tick": {"by": of(1, 300, "s")},
    "value_corrupted": {
        "value": st.sampled_from(["pose", "segment", "leg", "route"]),
        "kind": st.sampled_from(["nan", "none", "stale", "scaled"]),
    },
    "strategy_missing": {"strategy": STRATEGY},
    "strategy_wrong": {"strategy": STRATEGY},
    "strategy_slow": {"strategy": STRATEGY},
}
KILLS = {"process_killed"}  # and so tested in a process of its own


@st.composite
def faults(draw: st.DrawFn, name: str) -> dict[str, Any]:
    kind = draw(st.sampled_from(sorted(PARAMETERS)))
    entry: dict[str, Any] = {kind: {p: draw(of_it) for p, of_it in PARAMETERS[kind].items()}, "name": name}
    onsets: st.SearchStrategy[dict[str, Any]] = st.one_of(
        st.fixed_dictionaries({"time": of(0, 300, "s")}),
        st.fixed_dictionaries({"progress": share(0.0, 0.9)}),
        st.fixed_dictionaries({"node": NODE, "count": st.integers(1, 3)}),
    )
    entry["from"] = draw(onsets)
    if draw(st.booleans()):
        entry["for"] = draw(of(1, 600, "s"))
    if draw(st.booleans()):
        entry["profile"] = {"intermittent": {"period": draw(of(2, 120, "s"))}}
    return entry


def schedules() -> st.SearchStrategy[list[dict[str, Any]]]:
    one, two, three = (faults(name) for name in ("one", "two", "three"))
    return st.one_of(st.tuples(one), st.tuples(one, two), st.tuples(one, two, three)).map(list)


def test_every_fault_of_ports_and_executive_takes_part() -> None:
    specs = {name: registry.get(FAULT_KIND, name) for name in registry.names(FAULT_KIND)}
    anywhere = {name for name, spec in specs.items() if isinstance(spec, FaultSpec) and not spec.backends}
    assert set(PARAMETERS) == anywhere - KILLS


@settings(max_examples=15, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
@given(schedule=schedules())
def test_any_schedule_of_faults_leaves_the_rover_safe(
    tmp_path_factory: Any, schedule: list[dict[str, Any]]
) -> None:
    folder: Path = tmp_path_factory.mktemp("any")
    done = run(folder, *schedule, time_limit="20 min")
    assert done.breaches() == []
    assert done.outcome in OUTCOMES
    assert set(done.rows) == {fault["name"] for fault in schedule}
    if done.outcome == "error":
        kinds = {kind for fault in schedule for kind in fault}
        assert kinds & {"node_raises", "value_corrupted", "node_forced"}, done.finished.result.reason
