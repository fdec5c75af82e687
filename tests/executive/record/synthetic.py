"""A synthetic run to develop and test records and reports against: four way-points, 3 m, noise, one fault.

Nothing here simulates a rover: it is a plausible story told straight into the recorders.
"""

from __future__ import annotations

import dataclasses
import itertools
import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from executive.core.types import (
    Point,
    PoseEstimate,
    PoseSource,
    Segment,
)
from executive.record import (
    RunFigures,
    TruthRecorder,
    summarise,
    write_result,
)
from executive.record.events import (
    AnnotationsEvent,
    Box,
    Command,
    FaultEvent,
    HypothesesEvent,
    Level,
    LogEvent,
    NodeChange,
    Rock,
    RouteEvent,
    SegmentEvent,
    Spot,
    Start,
    Stop,
    StrategyEvent,
    Telemetry,
    TerrainEvent,
    TruthEvent,
    Verdict,
    WaypointEvent,
)
from executive.record.pictures import picture
from executive.record.recorder import Recorder
from executive.record.rows import row

WAYPOINTS = ((2.2, -0.6), (2.9, -0.1), (3.7, 0.1), (4.3, 0.8))
SPEED_M_S = 0.0014
TICK_S = 2.0
SCENARIO = """scenario: synthetic_traverse
seed: 7
tier: full
mission:
  mission: synthetic
  tree: navigate
  segments: {on_track: 30 mm, off_track: 250 mm, tolerance: 30 mm}
"""


def segments() -> tuple[Segment, ...]:
    points = [Point(x, y) for x, y in WAYPOINTS]
    return tuple(Segment(a, b, 0.03, 0.12, 0.03, i) for i, (a, b) in enumerate(itertools.pairwise(points)))


@dataclasses.dataclass
class _Rover:
    x: float
    y: float
    heading: float
    time: float = 0.0
    travel: float = 0.0
    turned: float = 0.0


class Story:
    """Tells the run: turn, localise, trek, correct; one tick at a time."""

    def __init__(self, record: Recorder, truth: TruthRecorder, rng: np.random.Generator) -> None:
        self.record, self.truth, self.rng = record, truth, rng
        self.rover = _Rover(WAYPOINTS[0][0] + 0.004, WAYPOINTS[0][1] - 0.003, 0.35)
        self.segment: Segment | None = None
        self.status: dict[str, str] = {}
        self.weights = {"nominal": 0.94, "slip_turning": 0.02, "track_asymmetry": 0.02, "marker_lost": 0.02}

    def note(self, path: str, status: str, reason: str = "", detail: str = "") -> None:
        if self.status.get(path) != status:
            self.status[path] = status
            self.record.write(NodeChange(path, status, reason, detail), self.rover.time)

    def quat(self) -> tuple[float, float, float, float]:
        pitch = 0.06 * math.sin(3 * self.rover.x) + 0.02
        roll = 0.05 * math.cos(4 * self.rover.y)
        x, y, z, w = Rotation.from_euler("ZYX", [self.rover.heading, pitch, roll]).as_quat()
        return (float(x), float(y), float(z), float(w))

    def tick(self, drive: float = 0.0, turn: float = 0.0, wanted: str = "") -> None:
        r = self.rover
        r.heading += turn
        r.x += drive * math.cos(r.heading)
        r.y += drive * math.sin(r.heading)
        r.travel += drive * 1.12
        r.turned += turn * 0.12
        r.time += TICK_S
        load = 0.11 + (0.05 if drive else 0.0) + (0.12 if turn else 0.0)
        left, right = load + 0.01 * self.rng.standard_normal(2)
        quat = self.quat()
        _, pitch, roll = Rotation.from_quat(quat).as_euler("ZYX")
        z = height(r.x, r.y)
        slip = 0.1 + 0.02 * self.rng.standard_normal() if drive else 0.0
        truth = TruthEvent(
            (r.x, r.y, z), quat, math.atan2(r.y, r.x), 0.4, 0, 0, slip, slip, math.hypot(r.x, r.y), 0.05
        )
        self.truth(truth, r.time)
        self.record.write(
            Telemetry(
                r.travel - r.turned,
                r.travel + r.turned,
                left,
                right,
                roll + 0.002 * self.rng.standard_normal(),
                pitch + 0.002 * self.rng.standard_normal(),
                0.0,
                0.0,
                math.atan2(r.y, r.x),
                0.4,
                math.hypot(r.x, r.y) + 0.1,
                0.05 + 0.03 * self.rng.random(),
                drive > 0 or turn != 0,
            ),
            r.time,
        )
        self.weigh(wanted or "nominal")
        self.record.flush()

    def weigh(self, wanted: str) -> None:
        for name in self.weights:
            aim = 0.88 if name == wanted else 0.04
            self.weights[name] += 0.12 * (aim - self.weights[name])
        total = sum(self.weights.values())
        event = HypothesesEvent({k: v / total for k, v in self.weights.items()}, None)
        self.record.write(event, self.rover.time)

    def localise(self, path: str, seconds: float = 30.0, fails: bool = False) -> PoseEstimate | None:
        self.note(path, "running")
        for _ in range(int(seconds / TICK_S)):
            self.tick(wanted="marker_lost" if fails else "")
        r = self.rover
        sigma = np.array([0.0016, 0.0016, 0.0012, 0.006, 0.006, 0.004])
        sigma[:2] = 0.0005 + 0.0005 * math.hypot(r.x, r.y)
        error = sigma * self.rng.standard_normal(6)
        self.images(fails)
        if fails:
            self.note(path, "failure", "not_seen", "2 of 4 markers seen in the left camera")
            return None
        rotation = Rotation.from_rotvec(error[3:]).inv() * Rotation.from_quat(self.quat())
        position = np.array([r.x, r.y, height(r.x, r.y)]) - error[:3]
        pose = PoseEstimate(
            r.time,
            (float(position[0]), float(position[1]), float(position[2])),
            tuple(float(q) for q in rotation.as_quat()),
            np.diag(sigma**2),
            "markers",
            markers=4,
        ).on(self.segment)
        self.record.write(pose, r.time)
        self.note(path, "success", "done", "4 markers")
        return pose

    def predict(self, pose: PoseEstimate, driven_m: float) -> None:
        h = pose.heading_rad
        x, y, z = pose.position_site_m
        moved = (x + driven_m * math.cos(h), y + driven_m * math.sin(h), z)
        grown = np.asarray(pose.covariance) + np.diag([1e-5, 1e-5, 1e-6, 1e-6, 1e-6, 1e-4]) * (
            1 + driven_m * 20
        )
        guess = dataclasses.replace(
            pose,
            time_s=self.rover.time,
            position_site_m=moved,
            covariance=grown,
            source=PoseSource.PREDICTION,
        )
        self.record.write(guess.on(self.segment), self.rover.time)

    def images(self, fails: bool) -> None:
        for camera, shift in (("left", 0), ("right", 11)):
            counts = self.rng.normal(140, 2, (256, 256))
            counts += 40 * np.exp(-((np.arange(256)[:, None] - 140) ** 2) / 4000)
            spots = [(110 + shift, 120), (150 + shift, 118), (154 + shift, 138), (106 + shift, 141)]
            lit = spots[:2] if fails else spots
            for u, v in lit:
                vv, uu = np.mgrid[0:256, 0:256]
                counts += 220 * np.exp(-((uu - u) ** 2 + (vv - v) ** 2) / 2.5)
            event, scale = picture(np.clip(counts, 0, 1023).astype(np.uint16), camera)
            self.record.write(event, self.rover.time)
            marks = tuple(Spot(i, u * scale, v * scale) for i, (u, v) in enumerate(spots))
            self.record.write(
                AnnotationsEvent(
                    camera,
                    "8 on/off pairs",
                    (Box(84 + shift, 96, 92, 66),),
                    marks[:2] if fails else marks,
                    tuple(Spot(s.marker, s.u + 0.4, s.v - 0.3) for s in marks),
                ),
                self.rover.time,
            )

    def strategy(self, name: str, hypothesis: str, verdict: Verdict, why: str) -> None:
        self.record.write(StrategyEvent(name, hypothesis, 0.87, 1, verdict, why), self.rover.time)

    def turn(self, base: str, bearing: float, efficiency: float) -> None:
        path = f"{base}/rotate_towards"
        self.note(path, "running")
        error = math.remainder(bearing - self.rover.heading, 2 * math.pi)
        self.record.write(Command("tracks", "drive", {"left_m": -0.1, "right_m": 0.1}), self.rover.time)
        steps = max(1, round(abs(error) / 0.02))
        for _ in range(steps):
            self.tick(turn=error * efficiency / steps, wanted="slip_turning" if efficiency < 0.8 else "")
        ok = efficiency > 0.8
        self.note(
            path, "success" if ok else "failure", "done" if ok else "off_heading", "" if ok else "9 deg left"
        )

    def traverse(self, segment: Segment) -> None:
        base = "navigate/for_each/traverse_segment/recover/sequence"
        pool = "navigate/for_each/traverse_segment/recover"
        self.segment = segment
        self.record.write(SegmentEvent(segment), self.rover.time)
        if segment.index == 1:
            self.turn(base, segment.bearing_rad, 0.55)
            why = "turned 0.55 of what was asked; the tracks slip on the spot"
            self.strategy("turning_slip_compensation", "slip_turning", Verdict.CHOSEN, why)
            self.note(f"{pool}/turning_slip_compensation", "running")
            self.turn(base, segment.bearing_rad, 0.97)
            self.note(f"{pool}/turning_slip_compensation", "success", "done")
            self.strategy("turning_slip_compensation", "slip_turning", Verdict.HELPED, "")
        else:
            self.turn(base, segment.bearing_rad, 0.97)
        if segment.index == 2:
            self.record.write(FaultEvent("led_off", True, "marker_lost"), self.rover.time)
            self.localise(f"{base}/localise", 60, fails=True)
            self.strategy("cabin_reposing", "marker_lost", Verdict.CHOSEN, "tilts the markers to the head")
            self.note(f"{pool}/cabin_reposing", "running")
            for _ in range(20):
                self.tick(wanted="marker_lost")
            self.record.write(FaultEvent("led_off", False), self.rover.time)
            self.note(f"{pool}/cabin_reposing", "success", "done")
            self.strategy("cabin_reposing", "marker_lost", Verdict.HELPED, "")
        pose = self.localise(f"{base}/localise")
        while pose is not None and segment.offset(pose.x_m, pose.y_m).remaining_m > 0.012:
            self.note(f"{base}/trek_to", "running")
            left = segment.offset(pose.x_m, pose.y_m)
            error = math.remainder(left.bearing_to_end_rad - pose.heading_rad, 2 * math.pi)
            hop = min(0.11, left.remaining_m)
            steps = max(1, int(hop / (SPEED_M_S * TICK_S)))
            for k in range(steps):
                drift = 0.004 * math.sin(2.5 * self.rover.x)
                self.tick(
                    drive=hop / steps, turn=(error + 0.02 * self.rng.standard_normal()) / steps + drift / 2
                )
                if k % 8 == 7:
                    self.predict(pose, hop * (k + 1) / steps)
            self.note(f"{base}/trek_to", "success", "done")
            pose = self.localise(f"{base}/localise", 16)
        if pose is not None:
            self.record.write(WaypointEvent(segment.index + 1, segment.end, pose), self.rover.time)
            self.record.write(
                LogEvent(Level.INFO, "navigate", f"way-point {segment.index + 1}"), self.rover.time
            )


def height(x: float, y: float) -> float:
    return 0.05 * math.sin(1.7 * x) * math.cos(1.3 * y) + 0.015 * math.sin(7 * x + 2 * y)


def terrain(rng: np.random.Generator) -> TerrainEvent:
    xs, ys = np.arange(-1.0, 6.0, 0.05), np.arange(-2.5, 2.5, 0.05)
    z = np.array([[height(x, y) for x in xs] for y in ys]) + 0.002 * rng.standard_normal((len(ys), len(xs)))
    rocks = tuple(
        Rock(float(x), float(y), float(r))
        for x, y, r in zip(
            rng.uniform(1.5, 5, 14), rng.uniform(-1.6, 1.8, 14), rng.uniform(0.03, 0.11, 14), strict=True
        )
    )
    return TerrainEvent((-1.0, -2.5), 0.05, z.astype(np.float32), rocks)


def make_run(folder: Path, seed: int = 7) -> Path:
    """Write a whole run folder but for its report; the same seed gives the same content."""
    folder.mkdir(parents=True, exist_ok=True)
    rng = np.random.default_rng(seed)
    (folder / "scenario.yaml").write_text(SCENARIO)
    with Recorder(folder / "record.mcap") as record, TruthRecorder(folder / "truth.mcap") as truth:
        story = Story(record, truth, rng)
        record.write(Start("synthetic_traverse", SCENARIO, seed, TICK_S, "full", {"longarm": "0.1.0"}), 0.0)
        record.write(terrain(rng), 0.0)
        record.write(RouteEvent(segments()), 0.0)
        story.note("navigate", "running")
        for segment in segments():
            story.traverse(segment)
        record.write(SegmentEvent(None), story.rover.time)
        story.note("navigate", "success")
        record.write(Stop("reached"), story.rover.time)
    wall = {"physics": 6.2, "render": 9.1, "perception": 4.0, "tick": 1.1, "record": 0.4}
    expectation = row("final_error below 30 mm", True, 0.019, "m")
    result = summarise(folder / "record.mcap", folder / "truth.mcap", RunFigures(21.3, wall))
    write_result(folder / "result.json", replace(result, expectations=(expectation,)))
    return folder


def read_result(folder: Path) -> dict[str, object]:
    result: dict[str, object] = json.loads((folder / "result.json").read_text())
    return result
