"""Full and geometric tier side by side: pose errors of the same localizer over the same standing rover.

    python benchmarks/tiers.py [--fixes 300] [--ranges 2 3 4.5]

Prints per range the RMSE of position and heading in both tiers, their ratio, and the mean NEES. The head is
turned away before each fix, so that its pointing error is drawn anew.
"""

from __future__ import annotations

import argparse

import numpy as np
from scipy.spatial.transform import Rotation

from executive.config.backends import BackendRequest
from executive.core.devices import HEAD
from executive.core.ports import LocaliseRequest
from executive.core.rig import RigCalibration
from executive.core.types import (
    Outcome,
    Point,
    PoseEstimate,
    PoseSource,
    Quality,
    Segment,
)
from executive.isc.attitude import quat_from_heading_tilt
from perception.localizer.localizer import LedStereoLocalizer
from sim_pybullet import BACKEND
from sim_pybullet.backend import SimBackend
from sim_pybullet.config import WorldConfig


def backend_at(range_m: float, tier: str) -> SimBackend:
    """A rover standing at this range on slightly rough ground."""
    route = (Segment(Point(range_m, 0.0), Point(range_m + 0.5, 0.3), 0.03, 0.25, 0.03),)
    world = WorldConfig.model_validate(
        {"terrain": {"procedural": {"roughness": "4 mm"}}, "start": {"heading": "30 deg"}}
    )
    request = BackendRequest(world, route, 11, tier, RigCalibration(), None, 1.0)
    return BACKEND.create(request)


def wait(backend: SimBackend, action) -> Outcome:
    while (outcome := action.poll()) is None:
        backend.advance()
    return outcome


def errors(range_m: float, tier: str, fixes: int) -> tuple[np.ndarray, np.ndarray]:
    """Errors (n, 6) of position [m] and rotation [rad], and NEES (n,)."""
    backend = backend_at(range_m, tier)
    localizer = LedStereoLocalizer(devices=backend.devices, rig=backend.rig, clock=backend.clock)
    prior = PoseEstimate(
        0.0,
        (range_m, 0.0, 0.0),
        quat_from_heading_tilt(np.radians(30.0), 0.0, 0.0),
        np.diag([0.02**2, 0.02**2, 0.05**2, 0.05**2, 0.05**2, 0.1**2]),
        PoseSource.PRIOR,
    )
    found, nees = [], []
    for _ in range(fixes):
        wait(backend, backend.devices[HEAD].point(0.1, 0.1))
        outcome = wait(backend, localizer.locate(LocaliseRequest(Quality.PRECISE, prior)))
        if not outcome.ok:
            continue
        truth = backend.world.scene().T_site_body
        pose = outcome.value.pose
        turned = Rotation.from_matrix(truth[:3, :3]) * Rotation.from_quat(pose.quat_site_body).inv()
        error = np.r_[truth[:3, 3] - pose.position_site_m, turned.as_rotvec()]
        found.append(error)
        nees.append(error @ np.linalg.solve(pose.covariance, error))
    backend.close()
    return np.array(found), np.array(nees)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--fixes", type=int, default=300)
    parser.add_argument("--ranges", type=float, nargs="+", default=[2.0, 3.0, 4.5])
    options = parser.parse_args()
    print("range  tier       found  position RMSE [mm]  heading RMSE [deg]  mean NEES")
    for range_m in options.ranges:
        rows = {}
        for tier in ("full", "geometric"):
            error, nees = errors(range_m, tier, options.fixes)
            position = 1e3 * np.sqrt((error[:, :3] ** 2).sum(axis=1).mean())
            heading = np.degrees(np.sqrt((error[:, 5] ** 2).mean()))
            rows[tier] = position, heading
            shown = f"{position:18.3f} {heading:19.4f} {nees.mean():10.2f}"
            print(f"{range_m:5.1f}  {tier:9s} {len(error):6d} {shown}", flush=True)
        ratios = [f / g for f, g in zip(*rows.values(), strict=True)]
        print(
            f"{range_m:5.1f}  full / geometric: position {ratios[0]:.3f}, heading {ratios[1]:.3f}", flush=True
        )


if __name__ == "__main__":
    main()
