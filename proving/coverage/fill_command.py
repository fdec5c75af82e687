"""`longarm fill`, also `longarm campaign fill`."""

from __future__ import annotations

import json
from pathlib import Path

import click

from executive.core.files import write_whole
from executive.report.figure import counted
from proving.coverage.excuses import Excuses, read_excuses
from proving.coverage.fill import Filled, file_name, text
from proving.coverage.fill import fill as look
from proving.coverage.search import Proposal

FILE = click.Path(path_type=Path)


@click.command("fill")
@click.argument("paths", nargs=-1, required=True, type=FILE)
@click.option(
    "-o",
    "--output",
    type=FILE,
    default=Path("proposed"),
    show_default=True,
    help="Folder for the scenarios proposed.",
)
@click.option("-j", "slots", default=1, show_default=True, metavar="N", help="Number of runs in parallel.")
@click.option(
    "--runs", type=click.IntRange(min=1), default=100, show_default=True, help="Maximum number of runs."
)
@click.option("--tier", help="Tier of every run.")
@click.option("--excuses", type=FILE, help="File of impossible outcomes, with reasons.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
@click.option("--quiet", is_flag=True, help="Show no progress on stderr.")
def fill(
    paths: tuple[Path, ...],
    output: Path,
    slots: int,
    runs: int,
    tier: str | None,
    excuses: Path | None,
    as_json: bool,
    quiet: bool,
) -> int:
    """Propose scenarios for what the scenarios in PATHS have not shown.

    Runs them, adds to one of them a fault that should provoke what was not seen, runs that, and keeps what
    fills a hole. What breaks a safety rule or crashes on the way is written too, as `wrong_...`.

    Example: longarm fill scenarios/ -o proposed/ -j 2 --tier geometric --runs 300
    """

    def tell(proposal: Proposal, ratio: float) -> None:
        if not (quiet or as_json):
            what = proposal.wrong or "; ".join(f"{i.name}: {i.word}" for i in proposal.fills[:4])
            click.echo(f"[{ratio:.1%}] {what}", err=True)

    given = read_excuses(excuses) if excuses else Excuses()
    found = look(paths, runs, slots, tier, given, tell)
    files = _write(found, output)
    if as_json:
        click.echo(json.dumps(_data(found, files), indent=2))
    else:
        click.echo(
            f"coverage {found.before:.1%} → {found.after:.1%} with "
            f"{counted(len(found.proposals), 'scenario')} in {output}, "
            f"after {counted(found.runs, 'run')}; {len(found.wrong)} went wrong"
        )
    return 0


def _write(found: Filled, folder: Path) -> dict[Path, Proposal]:
    folder.mkdir(parents=True, exist_ok=True)
    files: dict[Path, Proposal] = {}
    for proposal in (*found.proposals, *found.wrong):
        file, number = folder / f"{file_name(proposal)}.yaml", 2
        while file in files:
            file, number = folder / f"{file_name(proposal)}_{number}.yaml", number + 1
        write_whole(file, text(proposal, file.stem))
        files[file] = proposal
    return files


def _data(found: Filled, files: dict[Path, Proposal]) -> dict[str, object]:
    listing = [
        {"file": str(file), "fills": [str(i) for i in p.fills], "outcome": p.outcome, "wrong": p.wrong}
        for file, p in files.items()
    ]
    return {"before": found.before, "after": found.after, "runs": found.runs, "scenarios": listing}
