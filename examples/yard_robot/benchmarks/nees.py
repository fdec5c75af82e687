"""How honest the covariance of the marker poses is: `python benchmarks/nees.py [--number 400] [--seed 5]`.

Robots all over the yard, tilted a little, every other one with some faces covered: errors of the pose found
in units of its covariance (NEES, 6 expected), by the number of faces that it rests on.
"""

from __future__ import annotations

import argparse
from collections import defaultdict

import numpy as np
from scipy.spatial.transform import Rotation

from yard_robot.detection import find_markers
from yard_robot.marker_box import FACES, corners_body_m
from yard_robot.marker_pose import solve
from yard_robot.model import HuskyModel
from yard_robot.pole_camera import draw, project, window_around
from yard_robot.rig import YardRig

_TILT_RAD = 0.02


def main() -> None:
    """Draw, measure, print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--number", type=int, default=400)
    parser.add_argument("--seed", type=int, default=5)
    given = parser.parse_args()
    rng, rig = np.random.default_rng(given.seed), YardRig()
    model = HuskyModel(rig.rover, rig.box)
    corners_m = np.concatenate([corners_body_m(rig.box, face) for face in FACES])
    squares: dict[int, list[float]] = defaultdict(list)
    errors: dict[int, list[np.ndarray]] = defaultdict(list)
    refused: dict[str, int] = defaultdict(int)
    for number in range(given.number):
        x_m, slope, heading = rng.uniform((3.0, -0.5, -np.pi), (9.5, 0.5, np.pi))
        place = np.array([x_m, slope * x_m, 0.0])
        turned = Rotation.from_euler("xyz", [*rng.normal(0.0, _TILT_RAD, 2), heading])
        covered = rng.choice(FACES, rng.integers(0, 4), replace=False) if number % 2 else ()
        model.covered = frozenset(str(face) for face in covered)
        model.put(tuple(place), tuple(turned.as_quat()))
        window = window_around(rig.camera, project(rig.camera, turned.apply(corners_m) + place), 25.0)
        if window is None:
            continue
        found = solve(
            rig.camera, rig.box, find_markers(draw(model.client, rig.camera, window, 1.0, rng), window)
        )
        if isinstance(found, str):
            refused[found] += 1
            continue
        turn = (turned * Rotation.from_matrix(found.rotation).inv()).as_rotvec()
        off = np.concatenate([place - found.position_m, turn])
        squares[len(found.faces)].append(float(off @ np.linalg.solve(found.covariance, off)))
        errors[len(found.faces)].append(off)
    model.close()
    print("faces  number  NEES  95 %   max   rms x, y [mm]  heading [deg]")
    for faces, nees in sorted(squares.items()):
        rms = np.sqrt(np.mean(np.square(errors[faces]), axis=0))
        print(
            f"{faces:5} {len(nees):7} {np.mean(nees):5.1f} {np.percentile(nees, 95):5.1f} {max(nees):5.1f}"
            f"   {1e3 * rms[0]:5.1f} {1e3 * rms[1]:5.1f}   {np.degrees(rms[5]):10.2f}"
        )
    every = np.concatenate(list(squares.values()))
    print(f"  all {len(every):7} {every.mean():5.1f} {np.percentile(every, 95):5.1f} {every.max():5.1f}")
    for reason, count in refused.items():
        print(f"refused {count}: {reason}")


if __name__ == "__main__":
    main()
