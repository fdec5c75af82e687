"""Stereo pose against the Cramer-Rao bound of the same images; against solvePnP and least_squares for speed.

Run from the repository's root:  python -m benchmarks.pose_bound [--trials 500]
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import replace

import cv2
import numpy as np
from scipy.optimize import least_squares
from scipy.stats import chi2

from executive.core.clock import Stopwatch
from executive.core.rig import CabinCalibration, HeadCalibration, RigCalibration
from perception.frames.exposure import filter_snr_per_pair, pairs_needed, plate_view
from perception.geometry.body import Transform, points_in_body
from perception.geometry.camera import triangulate
from perception.geometry.pose import (
    Sighting,
    estimate,
    guess_body,
    roll_pitch,
)
from perception.geometry.rotation import exp_map
from tests.perception.synthetic import Scene, scene
from tests.perception.trials import run

RANGES_M = (1.6, 2.0, 3.0, 4.0, 5.0)
EXACT_RIG = replace(
    RigCalibration(),
    head=HeadCalibration(pan_accuracy_rad=0.0, tilt_accuracy_rad=0.0),
    cabin=CabinCalibration(joint_sigma_rad=0.0),
)


def bound_table(trials: int) -> None:
    low, high = chi2.ppf((0.025, 0.975), 6 * trials) / trials
    print(f"{trials} trials a row; NEES should lie in {low:.2f}..{high:.2f}")
    print("rig    range  pairs  found   position RMSE / bound        yaw RMSE / bound           NEES")
    for name, rig in (("exact", EXACT_RIG), ("real", RigCalibration())):
        for range_m in RANGES_M:
            true = scene(range_m, rig=rig)
            pairs = int(pairs_needed(filter_snr_per_pair(rig, plate_view(true.chain, true.state))))
            draws = np.random.default_rng([20, int(10 * range_m), int(name == "real")])  # rows of their own
            got = run(true, pairs, trials, draws)
            position = np.sqrt((got.errors[:, :3] ** 2).sum(axis=1).mean())
            yaw = np.degrees(np.sqrt((got.errors[:, 5] ** 2).mean()))
            print(
                f"{name:5s} {range_m:4.1f} m {pairs:5d} {len(got.errors) / trials:7.3f}"
                f"   {position * 1e3:6.3f} mm  x {got.position_ratio:5.3f}"
                f"        {yaw:6.4f} deg x {got.yaw_ratio:5.3f}     {got.nees.mean():6.2f}"
            )


def speed_table(repeats: int = 300) -> None:
    true, rng = scene(3.0), np.random.default_rng(3)
    measured = Sighting(
        true.uv_px + 0.1 * rng.standard_normal(true.uv_px.shape),
        np.broadcast_to(0.01 * np.eye(2), (2, 4, 2, 2)),
        true.state.head_rad,
        true.state.joints_rad,
        (float(roll_pitch(true.state.site_body.rotation)[0][0]), 0.0),
    )
    points = triangulate(true.chain.model, measured.uv_px)
    start = guess_body(true.chain, points, measured, [0, 1, 2, 3])

    def ours() -> object:
        triangulated = triangulate(true.chain.model, measured.uv_px)
        return estimate(true.chain, measured, guess_body(true.chain, triangulated, measured, [0, 1, 2, 3]))

    print("\nspeed (one pose)")
    for name, method in (
        ("ours: linear guess + Gauss-Newton, stereo, with covariance", ours),
        ("scipy least_squares lm, stereo, numerical Jacobian", lambda: by_scipy(true, measured, start)),
        ("cv2.solvePnP iterative, one camera", lambda: by_opencv(true, measured, cv2.SOLVEPNP_ITERATIVE)),
        ("cv2.solvePnP IPPE, one camera", lambda: by_opencv(true, measured, cv2.SOLVEPNP_IPPE)),
    ):
        print(f"  {seconds(method, repeats) * 1e3:8.3f} ms  {name}")


def by_scipy(true: Scene, measured: Sighting, start: Transform) -> object:
    """Pose alone, from pixels alone."""
    in_body, _ = points_in_body(true.chain.rig.cabin, true.chain.markers_plc_m, *measured.joints_rad)
    head = true.chain.site_ih(measured.head_rad).inverse()

    def misfit(p: np.ndarray) -> np.ndarray:
        site = in_body @ (exp_map(p[3:]) @ start.rotation).T + p[:3]
        return (true.chain.model.project(head.apply(site)) - measured.uv_px).ravel() / 0.1

    return least_squares(misfit, np.concatenate([start.position_m, np.zeros(3)]), method="lm")


def by_opencv(true: Scene, measured: Sighting, flag: int) -> object:
    camera = true.chain.rig.cameras[0]
    K = np.array([[camera.focal_px, 0, 511.5], [0, camera.focal_px, 511.5], [0, 0, 1.0]])
    return cv2.solvePnP(true.chain.markers_plc_m, measured.uv_px[0].copy(), K, None, flags=flag)


def seconds(method: Callable[[], object], repeats: int) -> float:
    method()
    watch = Stopwatch()
    for _ in range(repeats):
        method()
    return watch.elapsed_s() / repeats


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--trials", type=int, default=500)
    speed_table()
    bound_table(parser.parse_args().trials)
