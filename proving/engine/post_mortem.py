"""Who is to blame for the death of a child, and what its truncated record still tells."""

from __future__ import annotations

import signal
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import yaml

from executive.core.errors import LongarmError, RecordError
from executive.record import (
    History,
    Recorder,
    RunFigures,
    RunResult,
    events,
    read_result,
    summarise,
    write_result,
)
from executive.run import ResolvedScenario
from executive.run.judging import judged
from executive.run.resolve import resolve_scenario
from proving.engine import child
from proving.engine.case import LOG, Case, CaseClass, Ending
from proving.engine.server import Death

PLANTED_KILL = "process_killed"
"""The fault that lets the process kill itself: then a kill from nowhere is what was to be tested."""
_FROM_OUTSIDE = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGQUIT)
_LOG_LINES = 6


def ending_of(case: Case, death: Death, attempts: int) -> Ending:
    """What the death of a child means."""
    kind, cause, detail = _blame(case, death)
    return Ending(case, kind, cause, detail, death.wall_s, death.memory_bytes, attempts)


def _blame(case: Case, death: Death) -> tuple[CaseClass, str, str]:
    limits, status = case.limits, death.status
    if status is None:
        return CaseClass.INFRASTRUCTURE, "start", death.detail
    if death.killed == "hang":
        return CaseClass.SUT, "hang", f"no end within {limits.wall_s:g} s of wall time"
    if death.killed == "memory":
        return CaseClass.SUT, "memory", f"took more than {limits.memory_bytes / 2**20:.0f} MiB"
    if status < 0:
        return _blame_for_signal(case, signal.Signals(-status))
    match status:
        case child.DONE:
            return CaseClass.OK, "", ""
        case child.REFUSED:
            return CaseClass.REFUSED, "refused", last_words(case.folder)
        case child.DEFECT:
            return CaseClass.SUT, "error", reason_in(case.folder) or last_words(case.folder)
        case child.MEMORY:
            return CaseClass.SUT, "memory", f"asked for more than {limits.memory_bytes / 2**20:.0f} MiB"
        case child.MACHINE:
            return CaseClass.INFRASTRUCTURE, "disk", reason_in(case.folder) or last_words(case.folder)
    return CaseClass.SUT, "crash", f"exited with {status}"


def _blame_for_signal(case: Case, how: signal.Signals) -> tuple[CaseClass, str, str]:
    if how not in _FROM_OUTSIDE:
        return CaseClass.SUT, "crash", f"{how.name}\n{where_it_was(case.folder)}".strip()
    if killed_itself(case.folder):
        return CaseClass.SUT, "killed", f"{how.name}, as planted"
    return CaseClass.INFRASTRUCTURE, "killed", f"{how.name} from outside"


def killed_itself(folder: Path) -> bool:
    """Whether the record ends, without a stop, after the planted kill took effect."""
    record, names = folder / "record.mcap", _planted_kills(folder / "scenario.yaml")
    if not names or not record.is_file():
        return False
    history = History.of(record)
    fired = any(at.event.active and at.event.name in names for at in history.all(events.FaultEvent))
    return fired and history.last(events.Stop) is None


def _planted_kills(scenario: Path) -> set[str]:
    data = yaml.safe_load(scenario.read_text()) if scenario.is_file() else {}
    return {entry.get("name", PLANTED_KILL) for entry in data.get("faults", ()) if PLANTED_KILL in entry}


def settle(ending: Ending) -> RunResult:
    """The `result.json` of an ended case: as the child wrote it, else from what its record holds."""
    folder = ending.case.folder
    _drop_empty_log(folder)
    written = folder / "result.json"
    if written.is_file():
        with suppress(RecordError):  # cut off in the middle
            return read_result(written)
    return _summarised(ending)


def _summarised(ending: Ending) -> RunResult:
    folder, scenario = ending.case.folder, _scenario(ending.case.folder)
    record = folder / "record.mcap"
    folder.mkdir(parents=True, exist_ok=True)
    if not record.is_file():
        Recorder(record).close()  # it never began: an empty record says so, and the rest follows from it
    total = len(scenario.mission.waypoints) if scenario else None
    figures = RunFigures(ending.wall_s, waypoints_total=total)
    if scenario is not None:
        result, _ = judged(scenario, folder, figures)
        result = replace(result, scenario=scenario.name, seed=scenario.seed, tier=scenario.tier)
    else:
        result = summarise(record, folder / "truth.mcap", figures)
    said = ending.detail.splitlines()[:1]
    result = replace(result, outcome="error", reason=": ".join([ending.cause, *said]))
    write_result(folder / "result.json", result)
    return result


def _scenario(folder: Path) -> ResolvedScenario | None:
    with suppress(LongarmError):
        return resolve_scenario(folder / "scenario.yaml")
    return None


def reason_in(folder: Path) -> str:
    """The reason that `result.json` gives, nothing if there is none."""
    with suppress(OSError, RecordError):
        return read_result(folder / "result.json").reason or ""
    return ""


def last_words(folder: Path) -> str:
    """The last lines that the child printed."""
    with suppress(OSError):
        return "\n".join((folder / LOG).read_text(errors="replace").splitlines()[-_LOG_LINES:])
    return ""


def where_it_was(folder: Path) -> str:
    """What the fault handler wrote of the innermost calls when the child crashed."""
    with suppress(OSError):
        _, told, calls = (folder / LOG).read_text(errors="replace").rpartition("(most recent call first):")
        if told:
            return "\n".join(line.strip() for line in calls.strip().splitlines()[:3])
    return last_words(folder)


def _drop_empty_log(folder: Path) -> None:
    log = folder / LOG
    with suppress(FileNotFoundError):
        if log.stat().st_size == 0:
            log.unlink()
