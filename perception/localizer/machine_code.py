"""The vision kernels' machine code: made once an installation, where somebody reads what is going on.

    python -m perception.localizer.machine_code     # after installing; does nothing where it is there already

Each step works through the code with inputs as small as they come; what comes of it nobody needs.
"""

from __future__ import annotations

import sys
from collections.abc import Callable

import numpy as np

from executive.core.clock import Stopwatch
from executive.core.rig import RigCalibration
from executive.core.types import PoseEstimate
from perception.frames.difference import Difference
from perception.frames.psf import marker_spread
from perception.frames.similarity import compare
from perception.geometry.body import Transform
from perception.geometry.camera import triangulate
from perception.geometry.chain import Chain, ChainState, pose_estimate
from perception.geometry.follow_up import pointing_at
from perception.geometry.pose import Prior, Sighting, estimate, guess_body, linear_guess, roll_pitch
from perception.geometry.prediction import expect
from perception.geometry.rotation import exp_map, log_map
from perception.kernels.compiled import uncompiled
from perception.kernels.frames import equalised
from perception.markers.centres import find_markers
from perception.markers.joint import joint_fix

_CENTRE_PX = 0.1
_RANGE_M = 10.0
_WINDOW_PX = 120
_FLUX_COUNTS = 200.0


def poses() -> None:
    """A pose from centres."""
    chain, state = _rover()
    uv, _ = chain.project(state)
    covariance = np.tile(_CENTRE_PX**2 * np.eye(2), (*uv.shape[:2], 1, 1))
    body = state.site_body
    roll, pitch = roll_pitch(body.rotation)[0].tolist()
    sighting = Sighting(uv, covariance, state.head_rad, state.joints_rad, (roll, pitch))
    points = triangulate(chain.model, uv)
    start = guess_body(chain, points, sighting, list(range(uv.shape[1])))
    fit = estimate(chain, sighting, start, Prior(body, np.eye(6)))
    linear_guess(points, chain.markers_plc_m)
    log_map(exp_map(np.array([0.0, 0.0, 0.1])) @ fit.state.site_body.rotation)
    chain.project_points(points, state.head_rad, points, np.zeros((len(points), 3, 2)))


def images() -> None:
    """Frames of one scene, and a marker in their difference."""
    rng = np.random.default_rng(0)
    counts = rng.integers(300, 340, (3, 48, 48)).astype(np.uint16)
    still = compare(counts, 10.0)
    basis = np.stack([still.frames[0]] * 4)
    equalised(still.frames, still.frames[0], basis, basis, np.eye(4, dtype=np.float32), 40.0)
    image = rng.normal(0.0, 1.0, (48, 48)).astype(np.float32)
    image[20:24, 20:24] += 50.0
    find_markers(image, np.ones_like(image), marker_spread(RigCalibration(), 3.0))


def joint_detection() -> None:
    """All markers as one pose, in light that shows them clearly."""
    chain, state = _rover()
    spread = marker_spread(chain.rig, _RANGE_M)
    uv, _ = chain.project(state)
    corners = [tuple(int(x) - _WINDOW_PX // 2 for x in middle) for middle in uv.mean(axis=1)]
    pixels = np.arange(_WINDOW_PX)
    cameras = []
    for camera, corner in enumerate(corners):
        along_u, along_v = (
            [spread.profile(pixels - (place - corner[axis])) for place in uv[camera, :, axis]]
            for axis in (0, 1)
        )
        spots = [np.outer(v, u) for u, v in zip(along_u, along_v, strict=True)]
        light = (_FLUX_COUNTS * np.array(spots)).astype(np.float32)
        cameras.append(Difference(light, np.ones_like(light), light[0], 8))
    expectation = expect(chain, _estimated(state), state.head_rad, state.joints_rad, (0.0, 0.0))
    places = [(u, v) for u, v in corners]
    joint_fix(chain, cameras, places, spread, expectation, (0.0, 0.0))


STEPS: tuple[tuple[str, Callable[[], None]], ...] = (
    ("poses from centres", poses),
    ("markers one by one", images),
    ("all markers as one", joint_detection),
)


def prepare(tell: Callable[[str], None]) -> None:
    """Compile what is not on disk yet, and tell each step; silent and quick where all of it is."""
    if not uncompiled():
        return
    tell("compiling the vision kernels, once for this installation; takes about a minute ...")
    for name, step in STEPS:
        watch = Stopwatch()
        step()
        tell(f"  {name}: {watch.elapsed_s():.0f} s")


def _rover() -> tuple[Chain, ChainState]:
    """A rover that faces the head from its usual place."""
    chain = Chain.of(RigCalibration())
    body = Transform(np.eye(3), np.array([_RANGE_M, 0.0, 0.0]))
    return chain, ChainState(body, pointing_at(chain, body.position_m), (0.0, 1.0))


def _estimated(state: ChainState) -> PoseEstimate:
    return pose_estimate(0.0, state.site_body, np.diag([1e-3] * 3 + [1e-4] * 3), "prior")


if __name__ == "__main__":
    prepare(lambda line: print(line, file=sys.stderr, flush=True))  # noqa: T201  (a command)
