"""Cameras whose frames are as ordered, or which failed: fewer frames, or of another size, are no frames."""

from __future__ import annotations

from executive.core.ports import Action, Cameras
from executive.core.rig import SensorCalibration
from executive.core.types import (
    Centres,
    Images,
    Outcome,
    Reason,
    Shot,
)
from perception.frames.shots import check_frames


class CheckedCameras:
    """Passes shots on, and looks at what comes back."""

    def __init__(self, cameras: Cameras, sensor: SensorCalibration) -> None:
        self._cameras, self._sensor = cameras, sensor

    def take(self, shot: Shot) -> Action[Images | Centres]:
        """Order the shot; DEVICE if other frames come (frames.shots). See core.ports.Cameras."""
        return _Checked(self._cameras.take(shot), self._sensor)


class _Checked:
    def __init__(self, action: Action[Images | Centres], sensor: SensorCalibration) -> None:
        self._action, self._sensor = action, sensor
        self._outcome: Outcome[Images | Centres] | None = None

    def poll(self) -> Outcome[Images | Centres] | None:
        if self._outcome is None:
            self._outcome = self._checked(self._action.poll())
        return self._outcome

    def cancel(self) -> None:
        self._action.cancel()

    def _checked(self, outcome: Outcome[Images | Centres] | None) -> Outcome[Images | Centres] | None:
        if outcome is None or not isinstance(outcome.value, Images):
            return outcome
        try:
            check_frames(outcome.value, self._sensor)
        except ValueError as error:
            return Outcome(Reason.DEVICE, str(error))
        return outcome
