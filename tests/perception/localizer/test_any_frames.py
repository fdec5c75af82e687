"""Whatever the cameras return that shows no rover: a reason, or words on what was expected; never a pose."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from executive.core.rig import RigCalibration
from executive.core.types import (
    HeadReading,
    Images,
    Shot,
    Window,
)
from perception.frames.codes import coded_sequence
from perception.frames.difference import led_sequence
from perception.markers.marker_fix import MarkerFix, Rejection
from perception.markers.plausibility import choose
from perception.markers.shot_stack import ShotStack
from perception.markers.single import find_candidates
from perception.outline.moving_rover import moving_rover
from tests.perception.far_trials import draw, windows_of

RIG = RigCalibration()
NEAR = draw(3.0, np.random.default_rng(1), RIG, off=(0.01, 0.01))
FAR = draw(15.0, np.random.default_rng(2), RIG, off=(0.01, 0.01))
FULL = 2**RIG.sensor.bits - 1
ANY = settings(max_examples=60, deadline=None, derandomize=True)


def images(setting, leds, counts):
    head = HeadReading(0.0, *setting.said.head_rad, moving=False)
    return Images(0.0, Shot(leds), windows_of(setting), counts, head)


def near_answer(counts, leds=None):
    """As the localizer takes it: a problem of the frames is a refusal."""
    leds = leds or led_sequence(4, 1)
    said = NEAR.said
    seen = find_candidates(RIG, images(NEAR, leds, counts), 3.0)
    if seen.problem:
        return Rejection(seen.problem, 0)
    chain, prior = NEAR.true.chain, NEAR.expectation.prior
    return choose(chain, seen.candidates, said.head_rad, said.joints_rad, NEAR.tilt_rad, prior)


def far_answer(counts, leds=None):
    shots = ShotStack(FAR.true.chain)
    shots.add(images(FAR, leds or coded_sequence(4, 8), counts))
    if shots.problem:
        return Rejection(shots.problem, 0)
    return shots.fix(FAR.expectation, FAR.tilt_rad, 1.0)


def stack(window: Window, frames: int, content: str, rng) -> np.ndarray:
    """Frames without a rover: flat, saturated in part or whole, noise, stripes, or flashing all over."""
    shape = (frames, window.height, window.width)
    noise = rng.integers(0, FULL + 1, shape)
    made = {
        "black": np.zeros(shape),
        "grey": np.full(shape, 400),
        "saturated": np.full(shape, FULL),
        "half saturated": np.where(np.arange(shape[2]) < shape[2] // 2, FULL, 400 + noise // 300),
        "noise": noise,
        "faint noise": 400 + noise // 200,
        "stripes": np.where(np.arange(shape[1])[:, None] % 2, FULL, 0) + np.zeros(shape),
        "flashing": np.broadcast_to(rng.integers(0, FULL + 1, (frames, 1, 1)), shape),
        "hot pixels": np.where(rng.random(shape[1:]) < 0.01, FULL, 400 + noise // 300),
        "flickering pixels": np.where(rng.random(shape) < 0.001, FULL, 400 + noise // 300),
    }
    return made[content].astype(np.uint16)


CONTENTS = st.sampled_from(
    [
        "black",
        "grey",
        "saturated",
        "half saturated",
        "noise",
        "faint noise",
        "stripes",
        "flashing",
        "hot pixels",
        "flickering pixels",
    ]
)


def damage(counts: np.ndarray, how: str) -> object:
    """The same stack as nothing of the kind."""
    return {
        "colour": np.stack([counts] * 3, axis=-1),
        "one frame": counts[0],
        "a frame short": counts[:-1],
        "a frame more": np.concatenate([counts, counts[:1]]),
        "no frames": counts[:0],
        "a row short": counts[:, 1:],
        "turned": counts.transpose(0, 2, 1),
        "8 bit": (counts >> 2).astype(np.uint8),
        "16 bit": counts.astype(np.uint16) * np.uint16(64) | np.uint16(2048),
        "signed": counts.astype(np.int64),
        "floating": counts.astype(np.float64),
        "not a number": np.full(counts.shape, np.nan),
        "infinite": np.full(counts.shape, np.inf),
        "a list": counts.tolist(),
        "nothing": None,
    }[how]


SHAPES = ["colour", "one frame", "a frame short", "a frame more", "no frames", "a row short", "turned"]
VALUES = ["8 bit", "16 bit", "signed", "floating", "not a number", "infinite", "a list", "nothing"]
DAMAGES = SHAPES + VALUES


@ANY
@given(left=CONTENTS, right=CONTENTS, seed=st.integers(0, 99))
def test_frames_without_a_rover_give_a_reason_near_by(left, right, seed):
    rng, (a, b) = np.random.default_rng(seed), windows_of(NEAR)
    answer = near_answer((stack(a, 6, left, rng), stack(b, 6, right, rng)))
    assert isinstance(answer, Rejection)
    assert answer.why


@ANY
@given(left=CONTENTS, right=CONTENTS, seed=st.integers(0, 99))
def test_frames_without_a_rover_give_a_reason_far_off(left, right, seed):
    rng, (a, b) = np.random.default_rng(seed), windows_of(FAR)
    answer = far_answer((stack(a, 16, left, rng), stack(b, 16, right, rng)))
    assert isinstance(answer, Rejection)
    assert answer.why


@ANY
@given(left=CONTENTS, right=CONTENTS, seed=st.integers(0, 99))
def test_frames_without_a_rover_show_none_that_moves(left, right, seed):
    rng, (a, b) = np.random.default_rng(seed), windows_of(NEAR)
    counts = (stack(a, 2, left, rng), stack(b, 2, right, rng))
    assert moving_rover(NEAR.true.chain, NEAR.expectation, images(NEAR, (0, 0), counts), 3.0) is None


@pytest.mark.parametrize("how", DAMAGES)
@pytest.mark.parametrize("side", [0, 1])
def test_what_is_no_stack_of_grey_frames_is_refused_with_what_was_expected(how, side):
    rng = np.random.default_rng(3)
    for setting, frames, answer in ((NEAR, 6, near_answer), (FAR, 16, far_answer)):
        good = [stack(w, frames, "faint noise", rng) for w in windows_of(setting)]
        assert not isinstance(answer(tuple(good)), MarkerFix)
        good[side] = damage(good[side], how)
        with pytest.raises(ValueError, match=r"got .*expected"):
            answer(tuple(good))


@pytest.mark.parametrize("how", DAMAGES)
def test_a_moving_rover_is_not_looked_for_in_what_is_no_frame(how):
    windows = windows_of(NEAR)
    good = [stack(w, 2, "faint noise", np.random.default_rng(4)) for w in windows]
    good[1] = damage(good[1], how)
    with pytest.raises(ValueError, match=r"got .*expected"):
        moving_rover(NEAR.true.chain, NEAR.expectation, images(NEAR, (0, 0), tuple(good)), 3.0)


def test_one_camera_for_two_is_refused():
    only = stack(windows_of(NEAR)[0], 6, "faint noise", np.random.default_rng(5))
    with pytest.raises(ValueError, match="got 2 windows and 1 stacks, expected 2"):
        near_answer((only,))


def test_shots_of_different_windows_are_not_piled_up():
    rng, leds = np.random.default_rng(6), coded_sequence(4, 8)
    shots = ShotStack(FAR.true.chain)
    shots.add(images(FAR, leds, tuple(stack(w, 16, "faint noise", rng) for w in windows_of(FAR))))
    with pytest.raises(ValueError, match=r"expected .* as before"):
        shots.add(
            Images(
                0.0,
                Shot(leds),
                windows_of(NEAR),
                tuple(stack(w, 16, "faint noise", rng) for w in windows_of(NEAR)),
                HeadReading(0.0, *FAR.said.head_rad, moving=False),
            )
        )
