"""What authors of plug-ins write against (docs/plugins.md). It is stable; deeper imports are private."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from executive.config.backends import BackendRequest, BackendSpec
from executive.config.file_kinds import FileKind
from executive.config.localizers import LocalizerRequest, LocalizerSpec
from executive.config.reporter import Reporter
from executive.core.device_spec import DeviceSpec, Quantity, Verb
from executive.core.errors import Breach, ConfigError, LongarmError, PluginError
from executive.core.ports import Action, Backend, Devices, LocaliseRequest, Localizer
from executive.core.registry import Kind
from executive.core.types import (
    CameraView,
    Localisation,
    Outcome,
    Point,
    PoseEstimate,
    PoseSource,
    Quality,
    Reason,
    Segment,
)
from executive.core.values import (
    ANGLE,
    DURATION,
    FLAG,
    FORCE,
    INTEGER,
    LENGTH,
    NUMBER,
    POINT,
    POSE,
    QUALITY,
    ROUTE,
    SEGMENT,
    SPEED,
    TEXT,
    ValueAttribute,
    ValueType,
)
from executive.isc import Categorical, Channel, Comparison, Concern, Gaussian, Hypothesis, Measured
from executive.pool import Decision, Memory, Option, Policy, Situation, Strategy
from executive.record.events import DeviceReading, Telemetry, WaypointEvent
from executive.record.signal import Signal
from executive.run.fault import Cue, Fault, FaultSpec
from executive.run.instrument import Context, Instrument, InstrumentSpec, Judgement, Records, TreeParts
from executive.tree.abilities import FAILS, RUNS, SUCCEEDS, Abilities
from executive.tree.groot import Attribute, Groot, Variant
from executive.tree.nodes.action import ActionLeaf
from executive.tree.nodes.base import (
    Children,
    ControlNode,
    FromTree,
    In,
    InOut,
    Item,
    Leaf,
    NodeContext,
    Out,
)

if TYPE_CHECKING:
    from executive.testing import Bench as Bench
    from executive.testing import Ended as Ended
    from executive.testing import check_backend as check_backend
    from executive.testing import check_channel as check_channel
    from executive.testing import check_device as check_device
    from executive.testing import check_fault as check_fault
    from executive.testing import check_hypothesis as check_hypothesis
    from executive.testing import check_leaf as check_leaf
    from executive.testing import check_localizer as check_localizer
    from executive.testing import check_node as check_node
    from executive.testing import check_policy as check_policy
    from executive.testing import check_strategy as check_strategy

__all__ = [
    "ANGLE",
    "DURATION",
    "FAILS",
    "FLAG",
    "FORCE",
    "INTEGER",
    "LENGTH",
    "NUMBER",
    "POINT",
    "POSE",
    "QUALITY",
    "ROUTE",
    "RUNS",
    "SEGMENT",
    "SPEED",
    "SUCCEEDS",
    "TEXT",
    "Abilities",
    "Action",
    "ActionLeaf",
    "Attribute",
    "Backend",
    "BackendRequest",
    "BackendSpec",
    "Bench",
    "Breach",
    "CameraView",
    "Categorical",
    "Channel",
    "Children",
    "Comparison",
    "Concern",
    "ConfigError",
    "Context",
    "ControlNode",
    "Cue",
    "Decision",
    "DeviceReading",
    "DeviceSpec",
    "Devices",
    "Ended",
    "Fault",
    "FaultSpec",
    "FileKind",
    "FromTree",
    "Gaussian",
    "Groot",
    "Hypothesis",
    "In",
    "InOut",
    "Instrument",
    "InstrumentSpec",
    "Item",
    "Judgement",
    "Kind",
    "Leaf",
    "Localisation",
    "LocaliseRequest",
    "Localizer",
    "LocalizerRequest",
    "LocalizerSpec",
    "LongarmError",
    "Measured",
    "Memory",
    "NodeContext",
    "Option",
    "Out",
    "Outcome",
    "PluginError",
    "Point",
    "Policy",
    "PoseEstimate",
    "PoseSource",
    "Quality",
    "Quantity",
    "Reason",
    "Records",
    "Reporter",
    "Segment",
    "Signal",
    "Situation",
    "Strategy",
    "Telemetry",
    "TreeParts",
    "ValueAttribute",
    "ValueType",
    "Variant",
    "Verb",
    "WaypointEvent",
    "check_backend",
    "check_channel",
    "check_device",
    "check_fault",
    "check_hypothesis",
    "check_leaf",
    "check_localizer",
    "check_node",
    "check_policy",
    "check_strategy",
]


def __getattr__(name: str) -> Any:
    """The bench and the checkers, imported when asked for: a plug-in in use needs neither."""
    if name not in __all__:
        raise AttributeError(f"module 'longarm' has no attribute {name!r}")
    from executive import testing

    return getattr(testing, name)
