"""`longarm minimise`."""

from __future__ import annotations

import json
from functools import partial
from pathlib import Path

import click

from executive.core.files import write_whole

FILE = click.Path(path_type=Path)


@click.command("minimise")
@click.argument("case", type=FILE)
@click.option("-o", "--output", type=FILE, help="File to write.  [default: NAME-minimal.yaml]")
@click.option("--seed", type=int, help="Replace the scenario's seed.")
@click.option("--tier", help="Replace the scenario's tier.")
@click.option(
    "--runs", type=click.IntRange(min=1), default=200, show_default=True, help="Maximum number of runs."
)
@click.option("--loosely", is_flag=True, help="Keep what is violated first, not how it came to that.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
@click.option("--quiet", is_flag=True, help="Show no progress on stderr.")
def minimise(
    case: Path,
    output: Path | None,
    seed: int | None,
    tier: str | None,
    runs: int,
    loosely: bool,
    as_json: bool,
    quiet: bool,
) -> int:
    """Shrink a failing CASE, a run folder or a scenario file, to the least that still fails in the same way.

    Fewer faults, a shorter path, a simpler world, then simpler, shorter and weaker faults. What is first
    violated stays the same, and with it the failure's signature: how the run ends, for what reason, at which
    node, under which hypothesis.

    Example: longarm minimise runs/rock_on_path-7 -o scenarios/rock_minimal.yaml
    """
    from executive.report.figure import counted
    from proving.minimise.minimise import minimise as shrink

    silent = quiet or as_json
    heard = (lambda step: None) if silent else partial(click.echo, err=True)
    made = shrink(case, seed, tier, runs, heard, loosely)
    if made.failure is None:
        click.echo(f"{case}: this case does not fail; minimise needs one that does", err=True)
        return 1
    file = output or Path(f"{made.before['scenario']}-minimal.yaml")
    write_whole(file, made.text(case))
    sizes = {noun: {"before": before, "after": after} for noun, before, after in made.sizes()}
    if as_json:
        told = {"failure": str(made.failure), "file": str(file), "runs": made.runs, "sizes": sizes}
        told |= {"weaker": made.weaker, "steps": made.steps, "exhausted": made.exhausted}
        click.echo(json.dumps(told, indent=2))
        return 0
    for noun, size in sizes.items():
        click.echo(f"{size['before']} {noun} → {size['after']}")
    spent = f"after {counted(made.runs, 'run')}"
    if made.exhausted:
        spent = f"stopped {spent} (--runs {runs}); may shrink further"
    click.echo(f"{file} still fails with {made.failure}; {spent}")
    if made.weaker:
        click.echo(f"only a weaker failure was kept: {'; '.join(made.weaker)}")
    return 0
