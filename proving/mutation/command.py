"""`longarm mutate`."""

from __future__ import annotations

import json
from pathlib import Path

import click

from proving.coverage.command import share

FILE = click.Path(path_type=Path)


@click.command("mutate")
@click.argument("tree")
@click.argument("paths", nargs=-1, required=True, type=FILE)
@click.option("-j", "slots", default=1, show_default=True, metavar="N", help="Number of runs in parallel.")
@click.option("--limit", type=click.IntRange(min=1), metavar="N", help="Maximum number of mutants, sampled.")
@click.option("--seed", default=0, show_default=True, help="Seed of the sampling.")
@click.option("--only", multiple=True, metavar="TREE", help="Mutate this tree file only; may be repeated.")
@click.option("--tier", help="Tier of every run.")
@click.option("--set", "overrides", multiple=True, metavar="KEY=VALUE", help="Replace a value in every run.")
@click.option("--excuses", type=FILE, help="File of equivalent mutants, with reasons.")
@click.option("--believe", is_flag=True, help="Skip the mutants that --excuses names as equivalent.")
@click.option(
    "--min", "least", metavar="SHARE", help="Fail if a smaller share of mutants is noticed, such as 85 %."
)
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
@click.option("--quiet", is_flag=True, help="Show no progress on stderr.")
def mutate(
    tree: str,
    paths: tuple[Path, ...],
    slots: int,
    limit: int | None,
    seed: int,
    only: tuple[str, ...],
    tier: str | None,
    overrides: tuple[str, ...],
    excuses: Path | None,
    believe: bool,
    least: str | None,
    as_json: bool,
    quiet: bool,
) -> int:
    """Change TREE, the trees in it and its strategies, one little thing at a time; see which changes the
    scenarios in PATHS notice.

    A change is noticed when something that a scenario expects, and got, is no longer so. Survivors are shown
    with their diffs: each is a question that the suite does not ask.

    Example: longarm mutate navigate scenarios/ -j 2 --tier geometric --min "85 %"
    """
    from proving.mutation import mutate as mutation
    from proving.mutation.equivalents import Equivalents, read_equivalents
    from proving.mutation.table import as_data, as_text
    from proving.mutation.telling import Telling

    wanted = share(least)
    equivalents = read_equivalents(excuses) if excuses else Equivalents()
    options = mutation.MutationOptions(slots, tier, overrides, only, limit, seed, believe)
    path = Path(tree)
    name = path if path.is_file() or "/" in tree else tree
    score = mutation.mutate(name, paths, options, equivalents, Telling(quiet or as_json))
    click.echo(json.dumps(as_data(score), indent=2) if as_json else as_text(score), nl=as_json)
    problems = equivalents.problems(score.found, complete=limit is None and not only)
    for problem in problems:
        click.echo(problem, err=True)
    short = wanted is not None and score.ratio < wanted
    if short:
        click.echo(f"got {score.ratio:.1%} of the mutants noticed, expected at least {wanted:.0%}", err=True)
    return int(short or bool(problems))
