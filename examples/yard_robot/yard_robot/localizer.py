"""Finds the robot in the fixed camera's picture by the markers on its box."""

from __future__ import annotations

import math

import numpy as np
from executive.core.types import Vec2, Window
from longarm import (
    Action,
    CameraView,
    Localisation,
    LocaliseRequest,
    LocalizerRequest,
    LocalizerSpec,
    Outcome,
    PoseEstimate,
    Reason,
)
from scipy.spatial.transform import Rotation

from yard_robot.detection import DARK_COUNTS, brightness, find_markers
from yard_robot.devices import POLE_CAMERA
from yard_robot.eye import Eye, Picture
from yard_robot.marker_box import FACES, Array, corners_body_m
from yard_robot.marker_pose import MarkerPose, solve
from yard_robot.pole_camera import project, window_around
from yard_robot.rig import YardRig

LARGEST_SIGMA_M, LARGEST_SIGMA_RAD = 0.06, math.radians(2.0)
SOURCE = "yard_markers"
_MARGIN_PX, _SIGMAS = 25.0, 4.0


class MarkerLocalizer:
    """Looks where the robot should be; where it is not, at the whole yard."""

    def __init__(self, eye: Eye, rig: YardRig) -> None:
        self._eye, self._rig = eye, rig

    def locate(self, request: LocaliseRequest) -> Action[Localisation]:
        """Measure the pose; fails with the reason why there is none, never with a guess."""
        return _Looking(self, request)

    def pointing(self, pose: PoseEstimate) -> Vec2:
        """A fixed camera points where it points."""
        return 0.0, 0.0

    def windows(self, expected: PoseEstimate) -> tuple[Window, ...]:
        """Where to look: around the box of a robot that stands as expected, then everywhere."""
        camera, box = self._rig.camera, self._rig.box
        everywhere = Window(0, 0, camera.width_px, camera.height_px)
        box_px = project(camera, _placed(expected, np.concatenate([corners_body_m(box, f) for f in FACES])))
        range_m = math.dist(expected.position_site_m, (0.0, 0.0, camera.height_m))
        spread_px = _SIGMAS * expected.sigma_position_m * camera.focal_px / range_m
        near = window_around(camera, box_px, _MARGIN_PX + spread_px)
        return (everywhere,) if near is None else (near, everywhere)

    def expose(self, window: Window) -> Action[Picture]:
        """Take a picture."""
        return self._eye.expose(window)

    def judge(self, picture: Picture) -> Outcome[Localisation]:
        """What a picture says of the robot's pose."""
        seen = find_markers(picture.counts, picture.window)
        found = solve(self._rig.camera, self._rig.box, seen)
        views = (_view(picture, seen, None if isinstance(found, str) else self._shown(found, seen)),)
        if isinstance(found, MarkerPose):
            fix = _estimate(found, picture.time_s)
            return _accepted(Localisation(fix, views), fix)
        light = brightness(picture.counts)
        if light < DARK_COUNTS:
            return Outcome(Reason.UNSTABLE_IMAGES, f"too dark: {light:.0f} counts", Localisation(None, views))
        return Outcome(Reason.NOT_SEEN, found, Localisation(None, views))

    def _shown(self, found: MarkerPose, seen: dict[str, Array]) -> Array:
        """Where the pose found puts the corners of the markers seen [px]."""
        body_m = np.concatenate([corners_body_m(self._rig.box, face) for face in seen])
        return project(self._rig.camera, found.position_m + body_m @ found.rotation.T)


def _make(request: LocalizerRequest) -> MarkerLocalizer:
    return MarkerLocalizer(request.devices[POLE_CAMERA], request.rig)


YARD_MARKERS = LocalizerSpec(
    name="yard_markers",
    doc="ArUco markers on the robot's box, seen by the fixed camera.",
    sources=(SOURCE,),
    make=_make,
    tiers=("full",),
    needs=("pole_camera",),
    rig=YardRig,
)


class _Looking:
    """One localisation: the near window, and if that shows nothing the whole sensor."""

    def __init__(self, localizer: MarkerLocalizer, request: LocaliseRequest) -> None:
        self._localizer = localizer
        self._windows = list(localizer.windows(request.predicted))
        self._exposing = localizer.expose(self._windows.pop(0))
        self._outcome: Outcome[Localisation] | None = None

    def poll(self) -> Outcome[Localisation] | None:
        """The outcome, or None while under way."""
        taken = self._exposing.poll() if self._outcome is None else None
        if taken is None:
            return self._outcome
        if taken.value is None:
            reason = Reason.DEVICE if taken.ok else taken.reason
            self._outcome = Outcome(reason, taken.detail or "no picture")
            return self._outcome
        outcome = self._localizer.judge(taken.value)
        if outcome.reason is Reason.NOT_SEEN and self._windows:
            self._exposing = self._localizer.expose(self._windows.pop(0))
            return None
        self._outcome = outcome
        return outcome

    def cancel(self) -> None:
        """Stop looking."""
        self._exposing.cancel()
        self._outcome = self._outcome or Outcome(Reason.CANCELLED)


def _placed(pose: PoseEstimate, body_m: Array) -> Array:
    """Points (n, 3) of the body in `site`, its height left out: the yard is level."""
    rotation = Rotation.from_quat(pose.quat_site_body).as_matrix()
    placed: Array = np.array([pose.x_m, pose.y_m, 0.0]) + body_m @ rotation.T
    return placed


def _estimate(found: MarkerPose, time_s: float) -> PoseEstimate:
    x, y, z = found.position_m.tolist()
    qx, qy, qz, qw = Rotation.from_matrix(found.rotation).as_quat().tolist()
    return PoseEstimate(
        time_s, (x, y, z), (qx, qy, qz, qw), found.covariance, SOURCE, markers=len(found.faces)
    )


def _accepted(seen: Localisation, fix: PoseEstimate) -> Outcome[Localisation]:
    """The fix, if it is good enough to drive by."""
    if fix.sigma_position_m > LARGEST_SIGMA_M:
        return Outcome(Reason.POOR_VIEW, f"sigma {fix.sigma_position_m * 1e3:.0f} mm", seen)
    if fix.sigma_heading_rad > LARGEST_SIGMA_RAD:
        return Outcome(Reason.POOR_VIEW, f"sigma {math.degrees(fix.sigma_heading_rad):.1f} deg", seen)
    return Outcome(Reason.DONE, value=seen)


def _view(picture: Picture, seen: dict[str, Array], shown: Array | None) -> CameraView:
    nothing = np.empty((0, 2))
    detected = np.concatenate([*seen.values()]) if seen else nothing
    reprojected = nothing if shown is None else shown
    return CameraView(picture.window, picture.counts.astype(np.float32), detected, reprojected)
