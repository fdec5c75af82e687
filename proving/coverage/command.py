"""`longarm coverage`."""

from __future__ import annotations

import json
from pathlib import Path

import click

from executive.core.errors import ConfigError, Problem
from executive.core.units import FRACTION, UnitError, quantity
from proving.coverage.coverage import Coverage

FILE = click.Path(path_type=Path)


def share(text: str | None, option: str = "--min") -> float | None:
    """A share from the command line, `90 %` or `0.9`; ConfigError when it is none."""
    if text is None:
        return None
    try:
        value = quantity(text if "%" in text else float(text), FRACTION)
    except (UnitError, ValueError):
        raise ConfigError([Problem(option, 1, 1, f'got "{text}", expected a share such as 90 %')]) from None
    if not 0.0 <= value <= 1.0:
        raise ConfigError([Problem(option, 1, 1, f'got "{text}", expected 0 % to 100 %')])
    return value


def verdict(found: Coverage, least: float | None) -> int:
    """The exit code; what is wrong goes to stderr."""
    for problem in found.problems:
        click.echo(problem, err=True)
    ratio = found.share().ratio
    short = least is not None and ratio < least
    if short:
        click.echo(f"got a coverage of {ratio:.1%}, expected at least {least:.0%}", err=True)
    return int(short or bool(found.problems))


@click.command("coverage")
@click.argument("runs", nargs=-1, required=True, type=FILE)
@click.option("--excuses", type=FILE, help="File of impossible outcomes, with reasons.")
@click.option("--min", "least", metavar="SHARE", help="Fail below this coverage, such as 90 %.")
@click.option("-o", "--output", type=FILE, help="Write a drawing of the covered trees: .html or .svg.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
def coverage(
    runs: tuple[Path, ...], excuses: Path | None, least: str | None, output: Path | None, as_json: bool
) -> int:
    """Say which node outcomes, strategies, phases, faults and hypotheses the runs in RUNS have shown.

    Example: longarm coverage runs/ --excuses scenarios/coverage.yaml --min "90 %" -o coverage.html
    """
    from proving.coverage.coverage import cover
    from proving.coverage.drawing import write
    from proving.coverage.table import as_data, as_text

    wanted = share(least)
    found = cover(list(runs), excuses)
    if output is not None:
        write(found, output)
    click.echo(json.dumps(as_data(found), indent=2) if as_json else as_text(found), nl=as_json)
    return verdict(found, wanted)
