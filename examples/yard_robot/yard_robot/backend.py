"""The yard and its robot as a backend."""

from __future__ import annotations

from collections.abc import Mapping

from executive.core.clock import Clock, Stopwatch
from executive.core.devices import INCLINOMETER, LINK
from longarm import BackendRequest, BackendSpec, Devices, LongarmError

from yard_robot.config import YardConfig
from yard_robot.devices import BATTERY, POLE_CAMERA, WHEELS
from yard_robot.link import YardLink
from yard_robot.rig import YardRig
from yard_robot.truth import TruthFile
from yard_robot.world import World


class YardBackend:
    """A husky in PyBullet behind the ports. The truth leads to `truth.mcap` only."""

    def __init__(self, request: BackendRequest) -> None:
        if not isinstance(request.world, YardConfig):
            raise LongarmError(f"got a world of type {type(request.world).__name__}, expected a YardConfig")
        self.clock = Clock(request.tick_s)
        self._watch = Stopwatch()
        if not isinstance(request.rig, YardRig):
            raise LongarmError(f"got a rig of type {type(request.rig).__name__}, expected a YardRig")
        self.rig = request.rig
        with self._watch.measure("physics"):
            self.world = World(request.world, request.route, request.seed, self.rig, self.clock)
        self._truth = TruthFile(request.truth_path, self.world)
        self._link = YardLink(self.clock)
        self.devices = Devices(
            WHEELS.fit(self.world.wheels),
            BATTERY.fit(self.world.gauge),
            POLE_CAMERA.fit(self.world.eye),
            INCLINOMETER.fit(self.world.inclinometer),
            LINK.fit(self._link),
        )

    def advance(self) -> None:
        """Let one tick of mission time pass."""
        with self._watch.measure("physics"):
            self.world.advance()
        with self._watch.measure("render"):
            self.world.eye.settle()
        self._link.settle()
        self._truth.sample()
        self._truth.flush()

    def safe_stop(self) -> None:
        """Bring the robot to rest."""
        self.world.wheels.stop()

    def wall_s(self) -> Mapping[str, float]:
        """Wall time spent on physics and on rendering [s]."""
        return dict(self._watch.spent_s)

    def close(self) -> None:
        """Release the physics and close the truth; may be called twice."""
        self.world.close()
        self._truth.close()


BACKEND = BackendSpec(
    name="yard",
    doc="A husky in a level yard, seen by a camera on a pole; PyBullet.",
    world_model=YardConfig,
    tiers=("full",),
    devices=("wheels", "battery", "pole_camera", "inclinometer", "link"),
    rig=YardRig,
    create=YardBackend,
    strategies=("adopt_slip", "show_another_face", "wait_and_look", "back_up", "recharge"),
)
