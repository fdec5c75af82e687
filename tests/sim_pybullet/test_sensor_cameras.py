"""The cameras device: when frames are exposed, what each one saw, what is refused, and both tiers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from executive.core.clock import Clock
from executive.core.types import (
    Centres,
    HeadReading,
    Images,
    Reason,
    Shot,
    Window,
)
from sim_pybullet.cameras import make_cameras
from tests.sim_pybullet.sensor_scenes import (
    RIG,
    SUN,
    flat_ground,
    scene_at,
)

_WINDOWS = (Window(370, 440, 144, 128), Window(500, 440, 150, 128))


class Rig:
    """Cameras of a tier over a scene that a test may replace between ticks."""

    def __init__(self, tier: str, seed: int = 1, x_m: float = 4.0) -> None:
        self.clock = Clock()
        self.scene = scene_at(flat_ground(), x_m, 0.0)
        self.reading = HeadReading(0.0, self.scene.head_pan_rad, self.scene.head_tilt_rad, False)
        self.cameras = make_cameras(
            tier,
            RIG,
            self.clock,
            lambda: replace(self.scene, time_s=self.clock.now_s),
            lambda: replace(self.reading, time_s=self.clock.now_s),
            flat_ground(),
            SUN,
            np.random.default_rng(seed),
        )

    def tick(self) -> None:
        self.clock.advance()
        self.cameras.tick()

    def shoot(self, shot: Shot):
        action = self.cameras.take(shot)
        while (outcome := action.poll()) is None:
            self.tick()
        return outcome


@pytest.mark.parametrize("tier", ["full", "geometric"])
def test_a_shot_lasts_frames_times_cadence(tier):
    rig = Rig(tier)
    action = rig.cameras.take(Shot((0, 1, 2, 4, 8), _WINDOWS, cadence_s=0.5))
    for _ in range(2):
        assert action.poll() is None
        rig.tick()
    assert action.poll() is None
    rig.tick()
    outcome = action.poll()
    assert outcome.reason is Reason.DONE
    assert outcome.value.time_s == 3.0
    assert action.poll() is outcome


def test_images_have_the_shape_of_their_windows_and_ten_bits():
    images = Rig("full").shoot(Shot((0, 1, 2), _WINDOWS)).value
    assert isinstance(images, Images)
    assert [c.shape for c in images.counts] == [(3, 128, 144), (3, 128, 150)]
    assert all(c.dtype == np.uint16 and c.max() <= 1023 for c in images.counts)


def test_without_windows_both_full_frames_are_read():
    images = Rig("full").shoot(Shot((0,))).value
    assert [c.shape for c in images.counts] == [(1, 1024, 1024)] * 2
    assert images.windows == (Window(0, 0, 1024, 1024),) * 2


def test_each_frame_lights_its_own_leds():
    rig = Rig("full")
    rig.scene = replace(rig.scene, led_factor=(60.0,) * 4)
    masks = (0, 1, 2, 4, 8, 0, 15)
    counts = rig.shoot(Shot(masks, _WINDOWS)).value.counts[0].astype(float)
    lit = (counts - counts[0] > 60).sum(axis=(1, 2))
    assert [bool(n) for n in lit] == [bool(mask) for mask in masks]
    places = [np.unravel_index((counts[i] - counts[0]).argmax(), counts[0].shape) for i in range(1, 5)]
    assert len(set(places)) == 4
    assert all(counts[6][place] - counts[0][place] > 60 for place in places)


def test_a_moving_rover_is_seen_where_it_was_at_each_exposure():
    rig = Rig("full")
    action = rig.cameras.take(Shot((0, 0, 0), _WINDOWS, cadence_s=10.0))
    for second in range(1, 31):
        moved = scene_at(flat_ground(), 4.0, 0.002 * second)
        rig.scene = replace(moved, head_pan_rad=0.0, head_tilt_rad=rig.reading.tilt_rad)
        rig.tick()
    frames = action.poll().value.counts[0].astype(float)
    still = Rig("full", seed=9)
    for index, y_m in enumerate((0.0, 0.02, 0.04)):
        at = scene_at(flat_ground(), 4.0, y_m)
        still.scene = replace(at, head_pan_rad=0.0, head_tilt_rad=rig.reading.tilt_rad)
        alone = still.shoot(Shot((0,), _WINDOWS)).value.counts[0][0].astype(float)
        rms = [float(np.std(frames[i] - alone)) for i in range(3)]
        assert int(np.argmin(rms)) == index


def test_images_carry_the_encoders_reading_and_show_the_true_pointing():
    rig = Rig("full")
    truly = rig.shoot(Shot((0,), _WINDOWS)).value
    rig.scene = replace(rig.scene, head_pan_rad=rig.scene.head_pan_rad + 0.004)  # 10 px the encoder misses
    turned = rig.shoot(Shot((0,), _WINDOWS)).value
    assert turned.head.pan_rad == truly.head.pan_rad == rig.reading.pan_rad
    before, after = (i.counts[0][0].astype(float) for i in (truly, turned))
    assert np.std(after[:, 10:] - before[:, :-10]) < 0.5 * np.std(after - before)


def test_cancelled_and_replaced_shots_end_cancelled():
    rig = Rig("full")
    first = rig.cameras.take(Shot((0, 1), _WINDOWS))
    second = rig.cameras.take(Shot((0,), _WINDOWS, cadence_s=5.0))
    assert first.poll().reason is Reason.CANCELLED
    second.cancel()
    assert second.poll().reason is Reason.CANCELLED
    for _ in range(6):
        rig.tick()
    assert second.poll().reason is Reason.CANCELLED


@pytest.mark.parametrize(
    "shot",
    [
        Shot((0,), (Window(1000, 0, 25, 10), _WINDOWS[1])),
        Shot((0,), (_WINDOWS[0], Window(-1, 0, 25, 10))),
        Shot((0,), (_WINDOWS[0], Window(5, 5, 0, 10))),
        Shot((), _WINDOWS),
        Shot((0,), _WINDOWS, cadence_s=0.0),
        Shot((0,), _WINDOWS, exposure=0.0),
    ],
)
def test_a_shot_that_cannot_be_taken_is_refused_at_once_with_the_reason(shot):
    outcome = Rig("full").cameras.take(shot).poll()
    assert outcome.reason is Reason.OUT_OF_REACH
    assert "expected" in outcome.detail


@pytest.mark.parametrize("tier", ["full", "geometric"])
def test_same_seed_same_answer_another_seed_another(tier):
    shot = Shot((0, 1, 2, 4, 8) * 12 + (0,), _WINDOWS)

    def answer(seed: int) -> bytes:
        value = Rig(tier, seed).shoot(shot).value
        return value.uv_px.tobytes() if isinstance(value, Centres) else value.counts[0].tobytes()

    assert answer(4) == answer(4)
    assert answer(4) != answer(5)


def test_an_unknown_tier_is_named():
    with pytest.raises(ValueError, match="tier: got 'cheap', expected one of full, geometric"):
        Rig("cheap")


def test_half_the_exposure_gathers_half_the_light():
    whole, half = (
        Rig("full").shoot(Shot((0,), _WINDOWS, exposure=e)).value.counts[0].mean() for e in (1.0, 0.5)
    )
    assert half == pytest.approx(whole / 2, rel=0.01)
