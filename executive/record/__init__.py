"""The record of a run: start, events, stop, in mission time. Reports are made from it and nothing else."""

from executive.record.digest import digest
from executive.record.history import History
from executive.record.reader import Message, read_record, read_truth
from executive.record.recorder import Recorder, TruthRecorder
from executive.record.result import RunFigures, summarise, write_result

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
