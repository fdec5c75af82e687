"""The leaves by name, as tree files call them."""

from __future__ import annotations

from executive.nodes.always import Always
from executive.nodes.base import Leaf
from executive.nodes.cabin import SetCabin, ShowMarkers
from executive.nodes.conditions import Arrived, AsPredicted, Facing, InsideMargin, NotOvershot
from executive.nodes.drive_leg import DriveLeg
from executive.nodes.drive_straight import DriveBlind, DriveStraight
from executive.nodes.head import PointHead, TakePicture
from executive.nodes.help import CallForHelp
from executive.nodes.localise import Localise
from executive.nodes.plan import (
    BeginSegment,
    ChooseSide,
    Compensate,
    DeadReckon,
    DoubtPrediction,
    SetLeg,
    StartHere,
    WaypointReached,
)
from executive.nodes.turn_towards import TurnTowards
from executive.nodes.wait import Wait
from executive.nodes.watch_motion import WatchMotion

LEAVES: dict[str, type[Leaf]] = {
    "always": Always,
    "arrived": Arrived,
    "as_predicted": AsPredicted,
    "begin_segment": BeginSegment,
    "call_for_help": CallForHelp,
    "choose_side": ChooseSide,
    "compensate": Compensate,
    "dead_reckon": DeadReckon,
    "doubt_prediction": DoubtPrediction,
    "drive_blind": DriveBlind,
    "drive_leg": DriveLeg,
    "drive_straight": DriveStraight,
    "facing": Facing,
    "inside_margin": InsideMargin,
    "localise": Localise,
    "not_overshot": NotOvershot,
    "point_head": PointHead,
    "set_cabin": SetCabin,
    "set_leg": SetLeg,
    "show_markers": ShowMarkers,
    "start_here": StartHere,
    "take_picture": TakePicture,
    "turn_towards": TurnTowards,
    "wait": Wait,
    "watch_motion": WatchMotion,
    "waypoint_reached": WaypointReached,
}
