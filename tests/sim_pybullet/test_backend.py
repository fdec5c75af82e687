"""The backend as a whole, in both tiers: ports, time, safing, truth file."""

from __future__ import annotations

from pathlib import Path

import pytest

from executive.config.backends import BackendRequest
from executive.core.devices import CABIN, CAMERAS, DRIVE, HEAD
from executive.core.ports import Backend
from executive.core.rig import RigCalibration
from executive.core.types import (
    Centres,
    Images,
    Shot,
    Window,
)
from executive.record import read_truth
from sim_pybullet import BACKEND
from sim_pybullet.backend import SimBackend
from sim_pybullet.config import WorldConfig
from tests.sim_pybullet.worlds import AHEAD, plain

pytestmark = pytest.mark.sim

SHOT = Shot((0, 1, 2, 4, 8), (Window(448, 448, 128, 128),) * 2, 0.5)


def request(tier: str, truth: Path | None = None, **world: object) -> BackendRequest:
    config = WorldConfig.model_validate(plain(**world))
    return BackendRequest(config, AHEAD, 3, tier, RigCalibration(), truth, 1.0)


@pytest.mark.parametrize(("tier", "kind"), [("full", Images), ("geometric", Centres)])
def test_shot_is_delivered_after_its_time(tier: str, kind: type) -> None:
    backend: Backend = BACKEND.create(request(tier))
    action = backend.devices[CAMERAS].take(SHOT)
    ticks = 0
    while action.poll() is None:
        backend.advance()
        ticks += 1
    assert ticks == 3
    outcome = action.poll()
    assert outcome is not None
    assert outcome.ok
    assert isinstance(outcome.value, kind)
    backend.close()


def test_safe_stop_stops_everything_and_may_be_called_twice() -> None:
    backend = BACKEND.create(request("geometric"))
    d = backend.devices
    actions = [d[DRIVE].drive(0.1, 0.1, 0.0014), d[CABIN].move(0.3, 0.1), d[HEAD].point(0.5, 0.1)]
    backend.advance()
    backend.safe_stop()
    backend.safe_stop()
    backend.advance()
    assert all(a.poll() is not None for a in actions)
    assert not any(device.read().moving for device in (d[DRIVE], d[CABIN], d[HEAD]))
    backend.close()
    backend.close()


def test_truth_file_holds_the_path(tmp_path: Path) -> None:
    path = tmp_path / "truth.mcap"
    backend = BACKEND.create(request("geometric", path))
    backend.devices[DRIVE].drive(0.014, 0.014, 0.0014)
    for _ in range(12):
        backend.advance()
    backend.close()
    assert len(list(read_truth(path))) >= 11


def test_mast_height_of_the_world_is_that_of_the_rig() -> None:
    backend = BACKEND.create(request("geometric", mast_height="2.1 m"))
    assert backend.rig.head.mast_height_m == 2.1
    backend.close()


def test_world_faults_act_on_what_there_is_to_see() -> None:
    backend = BACKEND.create(request("geometric"))
    assert isinstance(backend, SimBackend)
    backend.world_faults.set_led(2, alive=False)
    backend.world_faults.dim_led(0, 0.3)
    rock = backend.world_faults.add_obstacle(3.5, 0.4, 0.1)
    scene = backend.world.scene()
    assert scene.led_alive == (True, True, False, True)
    assert scene.led_factor[0] == 0.3
    assert rock in scene.rocks
    backend.close()


def test_wall_time_is_told_by_part() -> None:
    backend = BACKEND.create(request("geometric"))
    backend.advance()
    assert backend.wall_s()["physics"] > 0.0
    backend.close()
