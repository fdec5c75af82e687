"""Run a recorded scenario again in a fresh process, and compare the records."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from executive.record import Divergence
    from proving.engine import Limits


@dataclass(frozen=True)
class Comparison:
    """A run and its repetition. `spoilt` says why there was none, where the machine is to blame."""

    recorded: str
    repeated: str
    divergence: Divergence | None
    spoilt: str = ""

    @property
    def identical(self) -> bool:
        return self.recorded == self.repeated and not self.spoilt


@click.command()
@click.argument("run_dir", type=click.Path(path_type=Path))
@click.option("--out", type=click.Path(path_type=Path), help="Folder to keep the new run in.")
@click.option("--json", "as_json", is_flag=True, help="Print the comparison as JSON and nothing else.")
def replay(run_dir: Path, out: Path | None, as_json: bool) -> int:
    """Run the scenario of a run folder again; say whether it came out bit for bit the same.

    Exit 1 if it did not: the first message of the records that differs is named.

    Example: longarm replay runs/first_traverse-7
    """
    from executive.run import changes
    from proving.engine import Limits

    for words in () if as_json else changes(run_dir):
        click.echo(f"changed since: {words}", err=True)
    return tell(str(run_dir), compare(run_dir, out, Limits()), as_json)


def compare(folder: Path, out: Path | None, limits: Limits) -> Comparison:
    """Run `folder`'s scenario again, into `out` if it is to be kept. RecordError if there is no record."""
    from executive.core.errors import RecordError
    from executive.record import cut_ticks, digest, first_divergence
    from proving.engine import Case, CaseClass, run_cases, settle

    scenario, record = folder / "scenario.yaml", folder / "record.mcap"
    if not scenario.is_file() or not record.is_file():
        raise RecordError(f"{folder}: got no scenario.yaml and record.mcap, expected a run folder")
    with TemporaryDirectory(prefix="longarm-") as temporary:
        into = out.absolute() if out else Path(temporary)
        case = Case("again", scenario.absolute(), into, limits=limits, cut_ticks=cut_ticks(record))
        (ending,) = run_cases([case], 1)
        settle(ending)
        if ending.kind is CaseClass.INFRASTRUCTURE:
            return Comparison(digest(record), "", None, f"{ending.cause}: {ending.detail}")
        again = into / "record.mcap"
        return Comparison(digest(record), digest(again), first_divergence(record, again))


def tell(what: str, found: Comparison, as_json: bool) -> int:
    """Print a comparison; the exit code."""
    divergence = vars(found.divergence) if found.divergence else None
    if as_json:
        told = {"identical": found.identical, "digest": found.recorded, "repeated": found.repeated}
        click.echo(json.dumps(told | {"divergence": divergence, "spoilt": found.spoilt or None}, indent=2))
    elif found.spoilt:
        click.echo(f"{what}: could not be run again: {found.spoilt}")
    elif found.identical:
        click.echo(f"{what}: identical, digest {found.recorded}")
    else:
        click.echo(f"{what}: differs {found.divergence}")
    return 0 if found.identical else 1
