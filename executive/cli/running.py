"""`longarm run`: begin a run, or go on with one that was killed, and say what it came to."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import click

from executive.cli import summary
from executive.config.find import located
from executive.run import app
from executive.run.instruments import broken_instruments
from executive.run.judging import DEFECT
from executive.run.resume import resume
from executive.tree.strategies import broken_strategies


@dataclass(frozen=True)
class Shown:
    """What of a run is printed: its result as JSON, nothing, or a progress bar and a summary."""

    as_json: bool
    quiet: bool

    @property
    def bar(self) -> bool:
        return not (self.quiet or self.as_json)


def begin(
    file: Path,
    seed: int | None,
    out: Path | None,
    tier: str | None,
    overrides: tuple[str, ...],
    force: bool,
    shown: Shown,
) -> int:
    """Run a scenario or mission, by path or name; the exit code."""
    _tell_what_is_missing(shown)
    file = located(file, "scenarios", "missions")
    options = app.RunOptions(seed, out, tier, overrides, bar=shown.bar, force=force, alone=True)
    return _told(app.run(file, options), shown)


def go_on(folder: Path, as_begun: bool, replaced: list[str], shown: Shown) -> int:
    """Go on with the run in this folder; the exit code. None of its values may be `replaced`."""
    if replaced:
        raise click.UsageError(
            f"got --resume and {', '.join(replaced)}, expected the run to go on as it began"
        )
    _tell_what_is_missing(shown)
    return _told(resume(folder, shown.bar, as_begun), shown)


def _tell_what_is_missing(shown: Shown) -> None:
    for broken in () if shown.quiet else (*broken_strategies(), *broken_instruments()):
        click.echo(f"longarm: the run does without {broken}", err=True)


def _told(finished: app.Finished, shown: Shown) -> int:
    if shown.as_json:
        click.echo(json.dumps(finished.result.to_json(), indent=2))
    elif not shown.quiet:
        summary.show(finished)
    if finished.exit_code == DEFECT:
        where = finished.folder / "traceback.txt"
        click.echo(f"longarm: a defect: {finished.result.reason} ({where})", err=True)
    return finished.exit_code
