"""The one loop: sense, tick, write what changed, let time pass; and rest in the end, whatever happens."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import partial

from py_trees.behaviour import Behaviour
from py_trees.common import Status

from executive.core.clock import Stopwatch
from executive.core.devices import DRIVE
from executive.core.errors import NodeRaised
from executive.core.interrupts import number_of, raise_swallowed, words_of
from executive.core.pause import pausable
from executive.core.ports import Backend, Devices
from executive.core.types import Outcome, Reason
from executive.record import events
from executive.record.journal import RunJournal
from executive.record.recorder import Recorder
from executive.run.cuts import LOOK, Cuts, Look
from executive.tree.nodes.base import Leaf, Trace
from executive.tree.nodes.guarded import Guarded
from executive.tree.nodes.services import Services

TELEMETRY_PERIOD_S = 10.0
SETTLING_S = 180.0  # as long as a belt may run on after its stop


@dataclass(frozen=True)
class RunEnd:
    """How a run ended: one of `result.json`'s outcomes, why, and the defect if it was one.

    `cut` says that a defect or the operator cut it short: what it proves or not is no question then.
    """

    outcome: str
    reason: str | None
    defect: BaseException | None = None
    cut: bool = False
    signal: int | None = None
    """The signal that asked for this end."""


@dataclass
class Run:
    """Everything that one run needs, made by the app."""

    root: Behaviour
    trace: Trace
    paths: Mapping[str, Behaviour]
    services: Services
    backend: Backend
    journal: RunJournal
    recorder: Recorder
    stopwatch: Stopwatch
    time_limit_s: float
    each_tick: Callable[[], None] = lambda: None
    invalid: Callable[[], str | None] = lambda: None
    """Asked at the end: why the run proves nothing, None if it does."""
    cuts: Cuts = field(default_factory=Cuts)


def execute(run: Run) -> RunEnd:
    """Run the tree to its end. Always: leaves terminated, rover at rest, stop written, record closed."""
    end, changes = RunEnd("error", "the run was interrupted", cut=True), _Changes(run)
    try:
        with pausable() as wait_while_paused:
            end = _loop(run, changes, wait_while_paused)
    except KeyboardInterrupt as interrupt:
        end = interrupted(interrupt)
    except Exception as defect:
        end = ended_by(defect)
    finally:
        end = _rest(run, changes, end)
    return end


def ended_by(defect: BaseException) -> RunEnd:
    """The end of a run that a defect cut short."""
    return RunEnd("error", _one_line(defect), defect, cut=True)


def interrupted(interrupt: KeyboardInterrupt) -> RunEnd:
    """The end of a run that a signal cut short."""
    return RunEnd("safe_hold", words_of(interrupt), cut=True, signal=number_of(interrupt))


def _loop(run: Run, changes: _Changes, wait_while_paused: Callable[[], None]) -> RunEnd:
    while True:
        _tick(run, changes, run.root)
        wait_while_paused()
        raise_swallowed()
        if run.root.status is not Status.RUNNING:
            return _ended(run)
        if _time_is_up(run):
            return _out_of_time(run)
        run.cuts.pass_by(run.services, run.journal)
        if run.cuts.look_due(run.services):
            _look(run, changes)
        _advance(run)


def _tick(run: Run, changes: _Changes, root: Behaviour) -> None:
    """Sense, tick, and write what changed."""
    watch = run.stopwatch
    with watch.measure("tick"):
        now = run.services.classification.tracker.sense(run.services.devices)
    run.each_tick()
    with watch.measure("tick"):
        root.tick_once()
    with watch.measure("record"):
        changes.write()
        if run.services.clock.ticks % max(1, run.services.clock.ticks_for(TELEMETRY_PERIOD_S)) == 0:
            run.journal.telemetry(now, run.services.devices, run.services.classification.predicted())
        run.recorder.flush()


def _advance(run: Run) -> None:
    with run.stopwatch.measure("advance"):
        run.backend.advance()


def _time_is_up(run: Run) -> bool:
    return run.services.clock.ticks >= run.services.clock.ticks_for(run.time_limit_s)


def _look(run: Run, changes: _Changes) -> None:
    """Stand still and look where the rover is; the tree waits meanwhile."""
    look = Look(run.services, run.trace, run.journal)
    changes.follow(LOOK, look.leaf)
    with look.standing_still():
        while look.under_way and not _time_is_up(run):
            _advance(run)
            _tick(run, changes, look.leaf)


def _out_of_time(run: Run) -> RunEnd:
    """A run that has called and waits for ground ends as one that was not answered."""
    call = run.journal.called
    if call is not None and any("link" in leaf.needs for leaf in run.trace.entered.values()):
        return RunEnd("help", f"{call.reason}: {call.detail}")
    return RunEnd("time_limit", f"still under way after {run.time_limit_s:.0f} s")


def _ended(run: Run) -> RunEnd:
    if run.root.status is Status.SUCCESS:
        missed = run.journal.missed()
        return RunEnd("safe_hold", missed) if missed else RunEnd("reached", None)
    failure = run.trace.last_failure
    reason = f"{failure[1].reason}: {failure[1].detail}" if failure else None
    call = run.journal.called
    if call is not None:
        return RunEnd("help", f"{call.reason}: {call.detail}")
    return RunEnd("safe_hold", "; ".join(filter(None, (reason, run.journal.missed()))) or None)


def _rest(run: Run, changes: _Changes, end: RunEnd) -> RunEnd:
    """Terminate every entered leaf, stop the rover, close the record; each whatever becomes of the others."""

    def judge() -> None:
        """Look for the last evidence, whatever the end; a run that came to its end may prove nothing."""
        nonlocal end
        why = run.invalid()
        if why and not end.cut:
            end = RunEnd("invalid", f"{why}; the run ended {end.outcome}")

    steps: tuple[Callable[[], object], ...] = (
        changes.write,
        run.trace.terminate_entered,
        changes.write,
        *_to_rest(run.services.devices),
        run.backend.safe_stop,
        lambda: _see_it_rest(run),
        judge,
        lambda: run.journal.write(events.Stop(end.outcome, end.reason)),
        run.recorder.close,
        run.backend.close,
    )
    for step in steps:
        try:
            step()
        except KeyboardInterrupt:
            continue  # the rest has priority over whoever is in a hurry
        except Exception as defect:
            end = replace(ended_by(end.defect or defect), signal=end.signal)
    return end


def _to_rest(devices: Devices) -> Iterator[Callable[[], object]]:
    """A step for each device that can be anything but at rest."""
    for fitted in devices:
        if fitted.spec.rest is not None:
            yield partial(fitted.spec.rest, fitted.device)


def _see_it_rest(run: Run) -> None:
    """A tick to settle, more while a belt runs on, one that must find it there, and a report.

    A stop nobody saw proves nothing.
    """
    by_s = run.services.clock.now_s + SETTLING_S
    run.backend.advance()
    while run.services.devices[DRIVE].read().moving and run.services.clock.now_s < by_s:
        run.backend.advance()
    run.backend.advance()
    now = run.services.classification.tracker.sense(run.services.devices)
    run.journal.telemetry(now, run.services.devices, run.services.classification.predicted())


def _one_line(defect: BaseException) -> str:
    text = str(defect) if isinstance(defect, NodeRaised) else f"{type(defect).__name__}: {defect}"
    return " ".join(text.split())


class _Changes:
    """Writes the nodes whose status changed since the last tick."""

    def __init__(self, run: Run) -> None:
        self._run, self._nodes = run, dict(run.paths)
        self._last: dict[str, Status] = dict.fromkeys(run.paths, Status.INVALID)
        self._outcomes: dict[str, Outcome[object]] = {}

    def follow(self, path: str, node: Behaviour) -> None:
        """From now on this node, which is none of the tree's, as well."""
        self._nodes[path], self._last[path] = node, Status.INVALID

    def write(self) -> None:
        self._outcomes.update(self._run.trace.take_ended())
        for path, status in self._changed():
            self._run.journal.write(self._event(path, status))
        self._outcomes.clear()

    def _changed(self) -> Iterator[tuple[str, Status]]:
        last, ended_again = self._last, self._outcomes
        for path, node in self._nodes.items():
            status = node.status
            if status is not last[path] or path in ended_again:
                last[path] = status
                yield path, status

    def _event(self, path: str, status: Status) -> events.NodeChange:
        outcome = self._outcomes.get(path)
        if outcome is None or not isinstance(self._nodes[path], Leaf | Guarded):
            return events.NodeChange(path, status.value.lower())
        reason = "" if outcome.reason is Reason.DONE else str(outcome.reason)
        return events.NodeChange(path, status.value.lower(), reason, outcome.detail)
