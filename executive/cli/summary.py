"""The summary of a run, for the terminal."""

from __future__ import annotations

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from executive.record import RunResult
from executive.record.rows import JudgedRow, worst_first
from executive.run.app import Finished


def show(finished: Finished) -> None:
    """Print how the run ended, its key figures, what was tried, and where the report is."""
    console, result = Console(), finished.result
    colour = "green" if finished.exit_code == 0 else "red"
    why = f": {result.reason}" if result.reason else ""
    console.print(f"[bold {colour}]{result.outcome}[/]{why}", highlight=False)
    table = Table(show_header=False, box=None, padding=(0, 2, 0, 0))
    for name, value in _figures(result):
        table.add_row(name, value)
    console.print(table)
    for row in worst_first(result.expectations):
        console.print(f"  {_verdict(row)}  {escape(_told(row))}", highlight=False, soft_wrap=True)
    for row in worst_first(row for row in result.safety or () if row.met is False):
        console.print(f"  [red]unsafe[/]   {escape(_told(row))}", highlight=False, soft_wrap=True)
    console.print(f"report: {finished.folder / 'report.html'}", highlight=False, soft_wrap=True)


def _verdict(row: JudgedRow) -> str:
    return "[green]met[/]    " if row.met else "[red]not met[/]"


def _told(row: JudgedRow) -> str:
    """The expectation; where it is not met, since when and by how much; and what to doubt of it."""
    found = [row.text]
    if row.t_violation_s is not None:
        found.append(f"from {row.t_violation_s:.0f} s")
    if row.met is False and row.robustness is not None:
        found.append(f"by {-row.robustness:.3g} {row.unit}".rstrip())
    if row.warning:
        found.append(row.warning)
    return ", ".join(found)


def _figures(result: RunResult) -> list[tuple[str, str]]:
    truth, seen = result.truth, result.localisation
    tried = ", ".join(row.name for row in result.strategies) or "none"
    cuts = ", ".join(f"{at_s / 60:.1f} min" for at_s in result.resumed_s)
    return [
        *([("cut off, and gone on at", cuts)] if cuts else []),
        ("way-points", f"{result.waypoints.reached} of {result.waypoints.total}"),
        ("true error at the end", _length(truth.final_error_m)),
        ("driven beyond the margin", _length(truth.driven_beyond_off_track_m)),
        ("localisations", f"{seen.count}, {seen.failed} failed, rmse {_length(seen.position_rmse_m)}"),
        ("strategies tried", tried),
        ("mission time", f"{result.mission_s / 60:.1f} min"),
        ("wall time", f"{result.wall_s or 0.0:.1f} s"),
    ]


def _length(value_m: float | None) -> str:
    return "not known" if value_m is None else f"{value_m * 1e3:.1f} mm"
