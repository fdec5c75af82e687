"""In-situ calibration of the head from views of rover and terrain: docs/calibration.md."""

from perception.calibration.parameters import NAMES, PARAMETERS, RigParameter, changed_rig
from perception.calibration.result import Calibrated, ParameterDirection
from perception.calibration.solve import calibrate
from perception.calibration.survey import Landmark, Look, PointImages, RoverImages, Station, Survey

__all__ = [
    "NAMES",
    "PARAMETERS",
    "Calibrated",
    "Landmark",
    "Look",
    "ParameterDirection",
    "PointImages",
    "RigParameter",
    "RoverImages",
    "Station",
    "Survey",
    "calibrate",
    "changed_rig",
]
