"""The record of a run: start, events, stop, in mission time. Reports are made from it and nothing else."""

from executive.record.digest import digest
from executive.record.history import History
from executive.record.reader import Message, read_record, read_truth
from executive.record.recorder import Recorder, TruthRecorder
from executive.record.result import RunFigures, summarise
from executive.record.run_result import RunResult, read_result, write_result

__all__ = [
    "History",
    "Message",
    "Recorder",
    "RunFigures",
    "RunResult",
    "TruthRecorder",
    "digest",
    "read_record",
    "read_result",
    "read_truth",
    "summarise",
    "write_result",
]
