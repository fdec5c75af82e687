"""The leaves by name, as tree files call them."""

from __future__ import annotations

from executive.tree.nodes.always import Always
from executive.tree.nodes.base import Leaf
from executive.tree.nodes.cabin import SetCabin, ShowMarkers
from executive.tree.nodes.conditions import (
    Arrived,
    AsPredicted,
    Facing,
    InsideMargin,
    NotOvershot,
)
from executive.tree.nodes.drive_leg import DriveLeg
from executive.tree.nodes.drive_straight import DriveBlind, DriveStraight
from executive.tree.nodes.head import PointHead, TakePicture
from executive.tree.nodes.help import CallForHelp
from executive.tree.nodes.localise import Localise
from executive.tree.nodes.plan import (
    BeginSegment,
    ChooseSide,
    Compensate,
    DeadReckon,
    DoubtPrediction,
    SetLeg,
    StartHere,
    WaypointReached,
)
from executive.tree.nodes.turn_towards import TurnTowards
from executive.tree.nodes.wait import Wait
from executive.tree.nodes.watch_motion import WatchMotion

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
