"""The record of a run: start, events, stop, in mission time. Reports are made from it and nothing else."""

from executive.telemetry.digest import digest
from executive.telemetry.history import History
from executive.telemetry.reader import Message, read_record, read_truth
from executive.telemetry.recorder import Recorder, TruthRecorder
from executive.telemetry.result import RunFigures, summarise, write_result

__all__ = [
    "History",
    "Message",
    "Recorder",
    "RunFigures",
    "TruthRecorder",
    "digest",
    "read_record",
    "read_truth",
    "summarise",
    "write_result",
]
