"""The record of a run: start, events, stop, in mission time. Reports are made from it and nothing else.

What other packages use of it stands here; the modules `events`, `truth` and `signals` are public too.
"""

from executive.record import events
from executive.record.bus import EventBus, Listener
from executive.record.continuation import cut_ticks
from executive.record.digest import digest
from executive.record.divergence import Divergence, first_divergence
from executive.record.evidence import DETECTION_GRACE_S, first_leading, leading
from executive.record.history import At, History
from executive.record.integrity import require_sound
from executive.record.reader import Message, read_record, read_truth
from executive.record.recorder import Recorder, TruthRecorder
from executive.record.result import RunFigures, summarise
from executive.record.rows import JudgedRow, first_violated, row, worst_first
from executive.record.run_folder import RUN_FILES, free_folder
from executive.record.run_result import (
    FalseAlarm,
    FaultStages,
    RunResult,
    StrategyRow,
    read_result,
    write_result,
)
from executive.record.signals import listener, live_types
from executive.record.versions import versions

__all__ = [
    "DETECTION_GRACE_S",
    "RUN_FILES",
    "At",
    "Divergence",
    "EventBus",
    "FalseAlarm",
    "FaultStages",
    "History",
    "JudgedRow",
    "Listener",
    "Message",
    "Recorder",
    "RunFigures",
    "RunResult",
    "StrategyRow",
    "TruthRecorder",
    "cut_ticks",
    "digest",
    "events",
    "first_divergence",
    "first_leading",
    "first_violated",
    "free_folder",
    "leading",
    "listener",
    "live_types",
    "read_record",
    "read_result",
    "read_truth",
    "require_sound",
    "row",
    "summarise",
    "versions",
    "worst_first",
    "write_result",
]
