"""Each leaf's declared outcomes are reached, on the fake robot, and each leaf ends in no other way."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from executive.config.backends import BackendRequest
from executive.core.devices import DRIVE, INCLINOMETER, TETHER
from executive.core.rig import RigCalibration
from executive.core.types import (
    Localisation,
    Outcome,
    Point,
    PoseEstimate,
    PoseSource,
    Quality,
    Reason,
    Segment,
    TetherReading,
    TiltReading,
)
from executive.isc import Classification, known_channels, known_hypotheses
from executive.isc.attitude import quat_from_heading_tilt
from executive.pool import Pool
from executive.record.bus import EventBus
from executive.record.journal import RunJournal
from executive.record.recorder import Recorder
from executive.testing import FakeBackend, FakeWorld, OverheadLocalizer
from executive.tree.catalogue import node_types
from executive.tree.nodes.base import (
    Constant,
    Leaf,
    Slot,
    Store,
    Trace,
)
from executive.tree.nodes.services import Services

SEGMENT = Segment(Point(2.0, 0.0), Point(3.0, 0.0), 0.03, 0.25, 0.03)
ENDS_HERE = Segment(Point(3.0, 0.0), Point(2.0, 0.0), 0.03, 0.25, 0.03, 1)
ROUTE = (SEGMENT, ENDS_HERE)
AHEAD, BEHIND, ASIDE = Point(2.5, 0.0), Point(1.95, 0.0), Point(2.0, 1.0)
PATIENCE_TICKS = 1500


@dataclass
class Ended:
    """An action that ended as soon as it was started."""

    outcome: Outcome[Any]

    def poll(self) -> Outcome[Any]:
        return self.outcome

    def cancel(self) -> None: ...


TYPES: dict[str, type[Leaf]] = {name: kind.leaf for name, kind in node_types().items() if kind.leaf}


class Bench:
    """One leaf at a time on a fake robot that stands at the start of a segment along x."""

    def __init__(self, folder: Path) -> None:
        request = BackendRequest(FakeWorld(), (SEGMENT,), 3, "geometric", RigCalibration(), None, 1.0)
        self.backend = FakeBackend(request)
        self.recorder = Recorder(folder / "record.mcap")
        self.journal = RunJournal(EventBus(self.backend.clock, [self.recorder.write]), ROUTE)
        self.localizer: Any = OverheadLocalizer(self.backend.devices, self.backend.rig, self.backend.clock)
        self.store, self.trace = Store(), Trace()
        self.classification = self.known(0.0)
        self.leaves: dict[str, Leaf] = {}
        self.looks: list[Any] = []

    def known(self, y_m: float, heading_rad: float = 0.0) -> Classification:
        """A classification that believes to be at (2, y) with small uncertainty."""
        prior = PoseEstimate(
            0.0,
            (2.0, y_m, 0.0),
            quat_from_heading_tilt(heading_rad, 0.0, 0.0),
            np.diag([1e-6] * 6),
            PoseSource.PRIOR,
        )
        return Classification(
            prior,
            self.backend.rig,
            self.backend.clock,
            known_hypotheses(),
            known_channels(),
            self.journal.assessment,
            markers_expected=4,
        )

    def run(self, kind: str, values: Mapping[str, object]) -> Outcome[object]:
        """Tick the leaf to its end; its outcome. The same one if it ran before."""
        services = Services(
            clock=self.backend.clock,
            devices=self.backend.devices,
            rig=self.backend.rig,
            localizer=self.localizer,
            classification=self.classification,
            pool=Pool((), self.journal.strategy),
            journal=self.journal,
        )
        given = {"pose": self.classification.predicted().on(SEGMENT), "segment": SEGMENT, **values}
        bindings = {}
        for port in TYPES[kind].ports():
            if port.direction.value == "in":
                bindings[port.name] = Constant(given.get(port.name, port.default))
            else:
                bindings[port.name] = Slot(self.store, port.name)
                bindings[port.name].write(given.get(port.name))
        if kind not in self.leaves:
            self.leaves[kind] = TYPES[kind](kind, kind, services, bindings, self.trace)
        leaf = self.leaves[kind]
        ended: list[Outcome[object]] = []
        for _ in range(PATIENCE_TICKS):
            self.classification.tracker.sense(self.backend.devices)
            leaf.tick_once()
            ended.extend(self.trace.take_ended().values())
            if ended:
                break
            self.backend.advance()
        (outcome,) = ended
        return outcome

    def device_ends(self, port: str, method: str, reason: Reason) -> None:
        setattr(self.backend.devices.named(port), method, lambda *args: Ended(Outcome(reason, "as told")))


Setup = Callable[[Bench], None]


def nothing(bench: Bench) -> None: ...


def ends(port: str, method: str, reason: Reason) -> Setup:
    return lambda bench: bench.device_ends(port, method, reason)


def sees(reason: Reason) -> Setup:
    def setup(bench: Bench) -> None:
        bench.localizer.locate = lambda request: Ended(Outcome(reason, "as told"))

    return setup


def tilted(bench: Bench) -> None:
    bench.backend.devices[INCLINOMETER].read = lambda: TiltReading(bench.backend.clock.now_s, 0.6, 0.0)


def held_back(bench: Bench) -> None:
    bench.backend.devices[TETHER].read = lambda: TetherReading(bench.backend.clock.now_s, 5.0, 6.0)


def believed_at(y_m: float, heading_rad: float = 0.0) -> Setup:
    def setup(bench: Bench) -> None:
        bench.classification = bench.known(y_m, heading_rad)

    return setup


def drifting(bench: Bench) -> None:
    """Believed near the margin and heading for it."""
    bench.classification = bench.known(0.24, 1.2)


def anomalous(bench: Bench) -> None:
    for _ in range(4):
        bench.classification.on_failure(Outcome(Reason.BLOCKED))


def turned(bench: Bench) -> None:
    bench.classification.observed_turn_ratio = 0.8


def turned_in_vain(bench: Bench) -> None:
    """Turns that end at once and leave everything as it was, six of them done."""
    bench.device_ends("tracks", "drive", Reason.DONE)
    for _ in range(6):
        assert bench.run("turn_towards", DRIVES["turn_towards"]).ok


def alarmed(bench: Bench) -> None:
    bench.trace.raise_alarm(Outcome(Reason.DEVICE, "as told"))


def jumped(bench: Bench) -> None:
    bench.backend.robot.x_m += 0.3


def unsure(bench: Bench) -> None:
    """Believed exactly at the way-point, to a standard deviation of 20 mm."""
    bench.classification = bench.known(0.0)
    bench.classification.tracker.inflate(0.02, 0.02, 0.01)


def coarse(bench: Bench) -> None:
    """What is believed is unsure, and no look at it is any better."""
    unsure(bench)
    sees_coarsely(bench)


def sees_coarsely(bench: Bench) -> None:
    class Coarse:
        def locate(self, request: Any) -> Ended:
            bench.looks.append(request)
            x_m = bench.backend.robot.x_m + 1e-4 * len(bench.looks)
            fix = replace(
                bench.classification.predicted(),
                time_s=bench.backend.clock.now_s,
                position_site_m=(x_m, 0.0, 0.0),
                covariance=np.diag([0.04**2] * 3 + [1e-4] * 3),
                source="overhead",
            )
            return Ended(Outcome(Reason.DONE, "", Localisation(fix)))

    bench.localizer = Coarse()


def unsure_and_sees(reason: Reason) -> Setup:
    def setup(bench: Bench) -> None:
        unsure(bench)
        sees(reason)(bench)

    return setup


HERE: dict[str, object] = {"target": Point(2.0, 0.0), "within": 0.03}
DRIVES: dict[str, dict[str, object]] = {
    "drive_blind": {"target": AHEAD},
    "drive_leg": {"target": AHEAD},
    "drive_straight": {"distance": 0.05},
    "turn_towards": {"target": ASIDE},
}
CASES: list[tuple[str, Reason, Setup, dict[str, object]]] = [
    ("always", Reason.DONE, nothing, {}),
    ("always", Reason.UNEXPECTED, nothing, {"success": False}),
    ("arrived", Reason.DONE, nothing, {"target": Point(2.01, 0.0), "within": 0.03}),
    ("arrived", Reason.GUARD, nothing, {"target": AHEAD, "within": 0.03}),
    ("as_predicted", Reason.DONE, nothing, {}),
    ("as_predicted", Reason.UNEXPECTED, anomalous, {}),
    ("begin_segment", Reason.DONE, nothing, {}),
    ("call_for_help", Reason.NO_STRATEGY, nothing, {}),
    ("choose_side", Reason.DONE, nothing, {"beside": 0.1, "ahead": 0.1}),
    ("choose_side", Reason.OFF_TRACK, nothing, {"beside": 0.3, "ahead": 0.1}),
    ("compensate", Reason.DONE, turned, {"of": "turning"}),
    ("compensate", Reason.GUARD, nothing, {"of": "advance"}),
    ("dead_reckon", Reason.DONE, nothing, {}),
    ("inflate_prediction", Reason.DONE, nothing, {}),
    ("drive_leg", Reason.OFF_HEADING, nothing, {"target": ASIDE}),
    ("drive_leg", Reason.OVERSHOOT, nothing, {"target": BEHIND}),
    ("drive_leg", Reason.OFF_TRACK, drifting, {"target": Point(2.1, 0.5)}),
    ("facing", Reason.DONE, nothing, {"target": AHEAD}),
    ("facing", Reason.OFF_HEADING, nothing, {"target": ASIDE}),
    ("inside_margin", Reason.DONE, nothing, {}),
    ("inside_margin", Reason.OFF_TRACK, believed_at(0.26), {}),
    ("localise", Reason.DONE, nothing, {}),
    *(
        ("localise", reason, sees(reason), {"quality": Quality.PRECISE})
        for reason in TYPES["localise"].outcomes
        if reason is not Reason.DONE
    ),
    ("measure_arrival", Reason.DONE, unsure, HERE),
    ("measure_arrival", Reason.ARRIVAL_UNCERTAIN, coarse, HERE),
    *(
        ("measure_arrival", reason, unsure_and_sees(reason), HERE)
        for reason in TYPES["localise"].outcomes
        if reason is not Reason.DONE
    ),
    ("not_overshot", Reason.DONE, nothing, {"target": AHEAD, "within": 0.03}),
    ("not_overshot", Reason.OVERSHOOT, nothing, {"target": BEHIND, "within": 0.03}),
    ("point_head", Reason.DONE, nothing, {}),
    ("point_head", Reason.OUT_OF_REACH, ends("head", "point", Reason.OUT_OF_REACH), {}),
    ("point_head", Reason.DEVICE, ends("head", "point", Reason.DEVICE), {}),
    ("set_cabin", Reason.DONE, nothing, {"arm": 0.2}),
    ("set_cabin", Reason.OUT_OF_REACH, nothing, {"arm": 3.0}),
    ("set_cabin", Reason.BLOCKED, ends("cabin", "move", Reason.BLOCKED), {}),
    ("set_cabin", Reason.DEVICE, ends("cabin", "move", Reason.DEVICE), {}),
    ("set_leg", Reason.DONE, nothing, {"to": 0.05}),
    ("show_markers", Reason.DONE, nothing, {}),
    ("show_markers", Reason.OUT_OF_REACH, nothing, {"arm": 3.0}),
    ("show_markers", Reason.BLOCKED, ends("cabin", "move", Reason.BLOCKED), {}),
    ("show_markers", Reason.DEVICE, ends("cabin", "move", Reason.DEVICE), {}),
    ("start_here", Reason.DONE, nothing, {"route": (SEGMENT,)}),
    ("start_here", Reason.OFF_TRACK, believed_at(0.04), {"route": (SEGMENT,)}),
    ("start_here", Reason.ARRIVAL_UNCERTAIN, unsure, {"route": (SEGMENT,)}),
    ("take_picture", Reason.DONE, nothing, {}),
    ("take_picture", Reason.DEVICE, ends("cameras", "take", Reason.DEVICE), {}),
    ("turn_towards", Reason.OFF_HEADING, turned_in_vain, {"target": ASIDE}),
    ("wait", Reason.DONE, nothing, {"duration": 3.0}),
    ("wait", Reason.DEVICE, alarmed, {"duration": 3.0}),
    ("watch_motion", Reason.UNEXPECTED, jumped, {}),
    ("waypoint_reached", Reason.DONE, nothing, {"segment": ENDS_HERE}),
    ("waypoint_reached", Reason.ARRIVAL_UNCERTAIN, unsure, {"segment": ENDS_HERE}),
    ("waypoint_reached", Reason.UNEXPECTED, nothing, {}),
]
for _name, _values in DRIVES.items():
    CASES += [
        (_name, Reason.DONE, nothing, _values),
        (_name, Reason.BLOCKED, ends("tracks", "drive", Reason.BLOCKED), _values),
        (_name, Reason.DEVICE, ends("tracks", "drive", Reason.DEVICE), _values),
        (_name, Reason.TILT, tilted, _values),
        (_name, Reason.TETHER, held_back, _values),
    ]
    if _name != "drive_leg":  # which refuses before it drives
        CASES.append((_name, Reason.OFF_TRACK, believed_at(0.3), _values))


@pytest.mark.parametrize(
    ("kind", "reason", "setup", "values"), CASES, ids=[f"{kind}-{reason}" for kind, reason, *_ in CASES]
)
def test_a_leaf_ends_for_the_reason_it_declares(
    tmp_path: Path, kind: str, reason: Reason, setup: Setup, values: dict[str, object]
) -> None:
    bench = Bench(tmp_path)
    setup(bench)
    outcome = bench.run(kind, values)
    bench.recorder.close()
    assert outcome.reason is reason
    assert bench.trace.entered == {}
    assert not bench.backend.devices[DRIVE].read().moving


def test_every_declared_outcome_of_every_leaf_has_its_case() -> None:
    declared = {(name, reason) for name, leaf in TYPES.items() for reason in leaf.outcomes}
    assert {(kind, reason) for kind, reason, *_ in CASES} == declared


def test_an_arrival_is_measured_as_finely_as_its_tolerance_asks(tmp_path: Path) -> None:
    bench = Bench(tmp_path)
    coarse(bench)
    bench.run("measure_arrival", HERE)
    bench.recorder.close()
    assert [request.position_sigma_m for request in bench.looks] == pytest.approx([0.009] * 3)


@pytest.mark.parametrize("values", [HERE, {**HERE, "target": AHEAD}])
def test_nothing_is_measured_where_the_pose_says_enough(tmp_path: Path, values: dict[str, object]) -> None:
    bench = Bench(tmp_path)
    sees_coarsely(bench)
    outcome = bench.run("measure_arrival", values)
    bench.recorder.close()
    assert (outcome.reason, bench.looks) == (Reason.DONE, [])
