"""`longarm campaign FILE` and its sub-commands, which plug-ins may add to."""

from __future__ import annotations

import json
import shlex
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING

import click

from executive.cli.command_group import CommandGroup
from executive.core.interrupts import number_of

if TYPE_CHECKING:
    from proving.campaign.cases import Campaign
    from proving.campaign.folder import CampaignFolder
    from proving.campaign.run import Engine
    from proving.campaign.tally import Ended

PATH = click.Path(path_type=Path)


class _CampaignGroup(CommandGroup):
    """What is not the name of a sub-command is a campaign to run."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        if args and args[0] not in (*self.list_commands(ctx), "-h", "--help"):
            args = ["run", *args]
        return super().parse_args(ctx, args)


@click.group(cls=_CampaignGroup, prefix="campaign.")
def campaign() -> None:
    """Run one scenario many times; each case draws the values that vary.

    `longarm campaign FILE` is short for `longarm campaign run FILE`.

    Example: longarm campaign random_faults --runs 500 -j 2
    """


@click.command()
@click.argument("file", type=PATH)
@click.option("--runs", type=click.IntRange(1), help="Number of runs; overrides the file.")
@click.option(
    "-j",
    "slots",
    type=click.IntRange(1),
    help="Number of cases run in parallel.  [default: 1; dask: all threads]",
)
@click.option("--engine", type=click.Choice(["local", "dask"]), default="local", show_default=True)
@click.option("--address", metavar="URL", help="Address of the Dask scheduler, such as tcp://host:8786.")
@click.option("--resume", is_flag=True, help="Continue an earlier start of this campaign, however it ended.")
@click.option("--out", type=PATH, help="Folder of the campaign.  [default: runs/NAME-SEED]")
@click.option("--json", "as_json", is_flag=True, help="Print campaign.json and nothing else.")
@click.option("--quiet", is_flag=True, help="Print nothing.")
def run(
    file: Path,
    runs: int | None,
    slots: int | None,
    engine: str,
    address: str | None,
    resume: bool,
    out: Path | None,
    as_json: bool,
    quiet: bool,
) -> int:
    """Run a campaign file. Exit 0 if every verdict is good.

    After Ctrl-C, a kill or a power cut, --resume continues: no case is lost, none is repeated.

    Example: longarm campaign random_faults --runs 500 -j 2 --out runs/faults
    """
    from executive.core.clock import Stopwatch
    from proving.campaign import run as running
    from proving.campaign.file import find_campaign, load_campaign
    from proving.campaign.folder import CampaignFolder
    from proving.campaign.progress import CampaignBar, show_summary
    from proving.campaign_report import write_campaign_report

    if (engine == "dask") != (address is not None):
        raise click.UsageError("--engine dask needs --address, and --address needs --engine dask")
    loaded, watch = load_campaign(find_campaign(file)), Stopwatch()
    repeats = runs or loaded.file.runs
    folder = CampaignFolder(out or _default_folder(loaded, resume))
    command = _command(file, runs, slots, engine, address, folder.path)
    about = running.about(loaded, repeats, command)
    work = _engine(engine, address, slots)
    bar = nullcontext(running.Watcher()) if quiet or as_json else CampaignBar(loaded.file.campaign)
    with bar as watcher, _resumable(folder, command):
        done = _begin(folder, about, resume)
        tally = running.run_campaign(loaded, folder, work, repeats, done, watcher)
    about["summary"] = running.summary(loaded, tally, watch, len(tally.ended) - len(done))
    folder.describe(about)
    write_campaign_report(folder.path)
    if as_json:
        click.echo(json.dumps(about, indent=2, ensure_ascii=False))
    elif not quiet:
        show_summary(about, str(folder.path))
    return 0 if all(case.good for case in tally.ended.values()) else 1


@click.command()
@click.argument("campaign_dir", type=PATH)
@click.argument("case", type=click.IntRange(0))
@click.option("--out", type=PATH, help="Folder to keep the new run in.")
@click.option("--json", "as_json", is_flag=True, help="Print the comparison as JSON and nothing else.")
def rerun(campaign_dir: Path, case: int, out: Path | None, as_json: bool) -> int:
    """Run one case of a campaign again in a fresh process; say whether it came out bit for bit the same.

    Exit 1 if it did not: the first message of the records that differs is named.

    Example: longarm campaign rerun runs/random_faults-7 42
    """
    from proving.campaign.folder import CampaignFolder, read_about
    from proving.campaign.shape import CaseLimits
    from proving.engine import Limits
    from proving.replay import compare, tell

    limits = CaseLimits.model_validate_json(json.dumps(read_about(campaign_dir)["limits"]))
    folder = CampaignFolder(campaign_dir).case(case)
    if not folder.is_dir():
        raise click.UsageError(f"got case {case}, expected the number of a case in {folder.parent}")
    return tell(f"case {case}", compare(folder, out, Limits(limits.wall, limits.memory)), as_json)


def _begin(folder: CampaignFolder, about: dict[str, object], resume: bool) -> list[Ended]:
    if not resume:
        folder.create(about)
        return []
    done = folder.resume(about)
    folder.describe(about)
    return done


@contextmanager
def _resumable(folder: CampaignFolder, command: str) -> Iterator[None]:
    """Says how to go on when interrupted."""
    try:
        yield
    except KeyboardInterrupt as interrupt:
        click.echo(f"interrupted; to go on: {command} --resume", err=True)
        raise click.exceptions.Exit(128 + number_of(interrupt)) from None
    finally:
        folder.close()


def _engine(name: str, address: str | None, slots: int | None) -> Engine:
    from proving.engine import run_cases

    if name == "dask" and address is not None:
        from proving.campaign.dask_engine import run_on_dask

        return lambda cases, begun: run_on_dask(address, cases, slots, begun)
    return lambda cases, begun: run_cases(cases, slots or 1, begun)


def _default_folder(loaded: Campaign, resume: bool) -> Path:
    """`runs/NAME-SEED`, the next free one, or to resume the last that is there."""
    from executive.record import free_folder

    name = f"{loaded.file.campaign}-{loaded.file.seed}"
    free = free_folder(Path("runs"), name)
    if not resume or free.name == name:
        return free
    number = int(free.name.rpartition("-")[2]) - 1
    return free.with_name(name if number == 1 else f"{name}-{number}")


def _command(
    file: Path, runs: int | None, slots: int | None, engine: str, address: str | None, out: Path
) -> str:
    words = ["longarm", "campaign", str(file), "--out", str(out)]
    for option, value in (("--runs", runs), ("-j", slots), ("--address", address)):
        words += [option, str(value)] if value is not None else []
    return shlex.join([*words, *(["--engine", engine] if engine != "local" else [])])
