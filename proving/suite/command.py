"""`longarm test`: scenario files as tests."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from proving.coverage.coverage import Coverage
    from proving.suite.run import Tested

_COLOURS = {"passed": "green", "expected failure": "yellow"}


@click.command()
@click.argument("paths", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option(
    "-j",
    "slots",
    type=click.IntRange(1),
    default=1,
    show_default=True,
    help="Number of scenarios run in parallel.",
)
@click.option(
    "--junit", type=click.Path(path_type=Path, dir_okay=False), help="Write JUnit XML to this file."
)
@click.option("--seed", type=click.IntRange(0), help="Replace the seed of every scenario.")
@click.option("--tier", help="Replace the tier of every scenario.")
@click.option(
    "--out",
    type=click.Path(path_type=Path, file_okay=False),
    default=Path("runs/test"),
    show_default=True,
    help="Folder for the run folders.",
)
@click.option(
    "--wall",
    "wall_s",
    type=click.FloatRange(min=1),
    default=900,
    show_default=True,
    help="Wall time limit of a scenario; beyond it, it counts as hanging [s].",
)
@click.option("--coverage", is_flag=True, help="Report what the suite has exercised.")
@click.option(
    "--coverage-min", metavar="SHARE", help="Fail below this coverage, such as 90% (implies --coverage)."
)
@click.option(
    "--excuses",
    type=click.Path(path_type=Path),
    help="File of impossible outcomes, with reasons (implies --coverage).",
)
@click.option("--json", "as_json", is_flag=True, help="Print the verdicts as JSON and nothing else.")
def test(
    paths: tuple[Path, ...],
    slots: int,
    junit: Path | None,
    seed: int | None,
    tier: str | None,
    out: Path,
    wall_s: float,
    coverage: bool,
    coverage_min: str | None,
    excuses: Path | None,
    as_json: bool,
) -> int:
    """Run scenarios as tests: files, bare names, and all in a folder. Exit 0 if every verdict is good.

    Good are: passed, and expected failure where the scenario says `expected_to_fail`.

    Example: longarm test scenarios/ -j 2 --tier geometric --junit results.xml
    """
    from proving.coverage.command import share
    from proving.coverage.table import as_data, as_text
    from proving.engine import Limits
    from proving.suite.collect import collect
    from proving.suite.junit import write_junit
    from proving.suite.run import SuiteOptions, run_suite

    least = share(coverage_min, "--coverage-min")
    collected = collect(paths, seed, tier)
    options = SuiteOptions(out, slots, seed, tier, Limits(wall_s=wall_s))
    rows: list[Tested] = []
    for row in run_suite(collected, options):
        rows.append(row)
        if not as_json:
            _tell(row)
    order = [each.name for each in collected]
    rows.sort(key=lambda row: order.index(row.collected.name))
    if junit is not None:
        write_junit(junit, rows)
    covered: Coverage | None = None
    code = 0
    if coverage or excuses or least is not None:
        covered, code = _coverage(rows, excuses, least)
    if as_json:
        told = {"counts": _counts(rows), "scenarios": [row.to_json() for row in rows]}
        click.echo(json.dumps(told | ({"coverage": as_data(covered)} if covered else {}), indent=2))
    else:
        click.echo(", ".join(f"{count} {word}" for word, count in _counts(rows).items()))
        click.echo(as_text(covered) if covered else "", nl=False)
    return 0 if all(row.verdict.good for row in rows) and not code else 1


def _coverage(rows: Sequence[Tested], excuses: Path | None, least: float | None) -> tuple[Coverage, int]:
    """What the runs have shown, and the exit code for it."""
    from proving.coverage.command import verdict
    from proving.coverage.coverage import cover

    found = cover([row.folder for row in rows], excuses)
    return found, verdict(found, least)


def _tell(row: Tested) -> None:
    word = str(row.verdict.word)
    head = click.style(f"{word:16}", fg=_COLOURS.get(word, "red"), bold=True)
    click.echo(f"{head} {row.collected.file}  {row.ending.wall_s:.1f} s")
    if row.verdict.message:
        click.echo(f"    {row.verdict.message}")
    if not row.verdict.good:
        click.echo(f"    repeat: {row.repeat}")


def _counts(rows: Sequence[Tested]) -> dict[str, int]:
    return dict(Counter(str(row.verdict.word) for row in rows))
