"""What a run came to: its result with the rows of every instrument, and the exit code that stands for it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from executive.record import History, RunResult, digest
from executive.record.result import RunFigures, summary_of
from executive.run.instrument import Records
from executive.run.instruments import instruments_there_are
from executive.run.resolved import ResolvedScenario

REACHED, OTHERWISE, DEFECT = 0, 1, 3


def judged(scenario: ResolvedScenario, folder: Path, figures: RunFigures) -> tuple[RunResult, bool | None]:
    """The result of a run, complete or cut off, from its records.

    And whether the run was as it should be, None where no instrument has an opinion.
    """
    record, truth = folder / "record.mcap", folder / "truth.mcap"
    history, world = History.of(record), History.of(truth) if truth.is_file() else History.empty()
    result = summary_of(history, world, digest(record), figures)
    records = Records(history, world, scenario.rig, result)
    found = [spec.judge(scenario.of(spec), records) for spec in instruments_there_are()]
    opinions = [each.met for each in found if each.met is not None]
    result = replace(
        result,
        expectations=tuple(row for each in found for row in each.expectations),
        safety=tuple(row for each in found for row in each.safety),
    )
    return result, all(opinions) if opinions else None


def exit_code(outcome: str, met: bool | None) -> int:
    """What the instruments say decides; where they say nothing, whether the goal was reached."""
    if outcome == "error" and not met:
        return DEFECT
    return REACHED if (outcome == "reached" if met is None else met) else OTHERWISE
