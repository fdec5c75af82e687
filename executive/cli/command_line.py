"""The `longarm` command. Thin: it parses arguments, calls, prints, and turns errors into exit codes.

0 good, 1 ended otherwise or problems found, 2 bad input or usage, 3 a defect, 128 + n ended by signal n.
"""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path

import click

from executive.cli.catalogue import CatalogueGroup
from executive.core.errors import DamagedError, LongarmError
from executive.core.files import write_whole
from executive.core.interrupts import number_of, raise_when_asked
from executive.core.registry import Project, in_project, project_file

DEFECT = 3


def main() -> None:
    """Entry point: everything that goes wrong ends in an exit code and words, never in a bare traceback."""
    raise_when_asked()
    code = invoke(sys.argv[1:])
    try:
        sys.stdout.flush()
    except OSError:  # whoever read this has gone
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    sys.exit(code)


def invoke(arguments: list[str]) -> int:
    """Run the command line; the exit code."""
    try:
        with in_project(_project(arguments)):
            code = cli.main(args=arguments, prog_name="longarm", standalone_mode=False)
    except click.exceptions.Exit as error:
        return error.exit_code
    except (click.exceptions.Abort, KeyboardInterrupt) as interrupt:
        asked = interrupt if isinstance(interrupt, KeyboardInterrupt) else interrupt.__cause__
        click.echo("longarm: interrupted", err=True)
        return 128 + number_of(asked)
    except click.ClickException as error:
        error.show()
        return 2
    except DamagedError as error:
        click.echo(str(error), err=True)
        return 1
    except LongarmError as error:
        click.echo(str(error), err=True)
        return 2
    except OSError as error:
        click.echo(f"longarm: {error}", err=True)
        return DEFECT
    except Exception as error:  # a defect: one line, the run folder has the traceback
        place = _deepest(error)
        words = " ".join(str(error).split())
        click.echo(f"longarm: a defect: {type(error).__name__}: {words} ({place})", err=True)
        return DEFECT
    return code if isinstance(code, int) else 0


def _project(arguments: list[str]) -> Project | None:
    """The project of the first file or folder that the command line names, else of the working folder."""
    if arguments[:1] == ["init"]:
        return None  # it reads what it has written itself; what lies there before may be anything
    named = next((Path(a) for a in arguments if not a.startswith("-") and Path(a).exists()), Path.cwd())
    if all(project_file(at) is None for at in (named, Path.cwd())):
        return None  # without reading one there is nothing to import
    from executive.config.project import project_for

    return project_for(named)


def _deepest(error: BaseException) -> str:
    trace = error.__traceback__
    while trace is not None and trace.tb_next is not None:
        trace = trace.tb_next
    if trace is None:
        return "no traceback"
    return f"{Path(trace.tb_frame.f_code.co_filename).name}:{trace.tb_lineno}"


@click.group(cls=CatalogueGroup, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="longarm", prog_name="longarm")
def cli() -> None:
    """Longarm: a behaviour-tree executive that drives a robot alone, with a pool of recovery strategies.

    Example: longarm run missions/first_traverse.yaml
    """


FILE = click.Path(path_type=Path)


@cli.command()
@click.argument("file", type=FILE, required=False)
@click.option("--resume", "run_dir", type=FILE, metavar="RUN_DIR", help="Go on with a run that was killed.")
@click.option("--as-begun", is_flag=True, help="With --resume: the files as the run folder keeps them.")
@click.option("--seed", type=int, help="Replace the scenario's seed.")
@click.option("--out", type=FILE, help="Where to write the run folder.")
@click.option("--tier", help="Replace the scenario's tier: one that its backend has.")
@click.option(
    "--set", "overrides", multiple=True, metavar="KEY=VALUE", help="Replace one value of the scenario."
)
@click.option("--force", is_flag=True, help="Write over the run that --out holds already.")
@click.option("--json", "as_json", is_flag=True, help="Print result.json and nothing else.")
@click.option("--quiet", is_flag=True, help="Print nothing.")
def run(
    file: Path | None,
    run_dir: Path | None,
    as_begun: bool,
    seed: int | None,
    out: Path | None,
    tier: str | None,
    overrides: tuple[str, ...],
    force: bool,
    as_json: bool,
    quiet: bool,
) -> int:
    """Run a scenario or a mission, by path or name, and write its run folder.

    Example: longarm run missions/first_traverse.yaml --seed 3 --set "world.light.sun_elevation=20 deg"
    """
    from executive.cli import running

    shown = running.Shown(as_json, quiet)
    if run_dir is not None and file is None:
        given = {"--seed": seed, "--out": out, "--tier": tier, "--set": overrides, "--force": force}
        return running.go_on(run_dir, as_begun, [name for name, value in given.items() if value], shown)
    if file is None:
        raise click.UsageError("got no FILE, expected a scenario or a mission, or --resume RUN_DIR")
    if run_dir is not None or as_begun:
        raise click.UsageError("got FILE and --resume, expected the one or the other")
    return running.begin(file, seed, out, tier, overrides, force, shown)


@cli.command("verify-record")
@click.argument("run_dir", type=FILE)
@click.option("--json", "as_json", is_flag=True, help="Print what was found as JSON.")
def verify_record(run_dir: Path, as_json: bool) -> int:
    """Say whether the records of a run are what was written: exit 1 and where, if not.

    Example: longarm verify-record runs/first_traverse-0
    """
    from executive.record.verify import verify

    found = verify(run_dir)
    if as_json:
        click.echo(json.dumps({"sound": not found.problems, "problems": list(found.problems)}, indent=2))
    else:
        click.echo("\n".join(found.problems) or f"{run_dir}: the records are what was written")
    return int(bool(found.problems))


@cli.command()
def prepare() -> int:
    """Make what is made once on a machine, such as machine code; done already, it takes a second.

    Example: longarm prepare
    """
    from executive.config.localizers import LOCALIZER_KIND
    from executive.core import registry

    for spec in registry.every(LOCALIZER_KIND).values():
        spec.prepare(lambda line: click.echo(line, err=True))
    return 0


@cli.command()
@click.argument("folder", type=FILE)
def report(folder: Path) -> int:
    """Write the self-contained report.html of a run or campaign folder anew, from its record.

    Example: longarm report runs/first_traverse-7
    """
    from executive.run import app

    click.echo(app.report(folder))
    return 0


@cli.command()
@click.argument("run_dir", type=FILE)
@click.option("--at", metavar="TIME", help="Mission time such as '12 min' or 720; the end by default.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
def explain(run_dir: Path, at: str | None, as_json: bool) -> int:
    """Say why: the chain from leaf to root, hypotheses with weights, what was tried and why that.

    Example: longarm explain runs/marker_out-7 --at "20 min"
    """
    from executive.report import explain as explaining

    found = explaining.explain(run_dir, at)
    if as_json:
        click.echo(json.dumps(found.as_json(), indent=2, ensure_ascii=False))
    else:
        click.echo(explaining.as_text(found), nl=False)
    return 0


@cli.command()
@click.argument("files", nargs=-1, required=True, type=FILE)
@click.option("--format", "form", type=click.Choice(["text", "json", "sarif"]), default="text")
@click.option("--json", "as_json", is_flag=True, help="The same as --format json.")
def check(files: tuple[Path, ...], form: str, as_json: bool) -> int:
    """Analyse trees, missions, scenarios and campaigns without running them; print every problem.

    Warnings alone do not count as problems: exit 0.

    Example: longarm check trees/*.yaml missions/*.yaml --format sarif
    """
    from executive.config.find import located
    from executive.run import check as checking

    files = tuple(located(file, "scenarios", "missions", "trees", "campaigns") for file in files)
    missing = [file for file in files if not file.is_file()]
    for file in missing:
        click.echo(
            f"{file}:1:1: {'got a folder, expected a file' if file.is_dir() else 'no such file'}", err=True
        )
    if missing:
        return 2
    problems = sorted({problem for file in files for problem in checking.check_file(file)})
    click.echo(checking.written(problems, "json" if as_json else form), nl=False)
    return 1 if any(not problem.warning for problem in problems) else 0


@cli.command()
@click.argument("tree")
@click.option("--format", "form", default="unicode", show_default=True, help="How to draw.")
@click.option("-o", "--output", type=FILE, help="Write to this file instead of stdout.")
def show(tree: str, form: str, output: Path | None) -> int:
    """Draw a tree, by name or path, or a run's tree with its outcomes, by run folder.

    Formats: unicode, dot, svg, png, mermaid, html, groot.

    Example: longarm show navigate --format svg -o navigate.svg
    """
    from executive.config.validate import guess, listed
    from executive.report.show import FORMATS, draw
    from executive.run import app
    from executive.tree.load import load_tree
    from executive.tree.strategies import usable_trees

    if form not in FORMATS:
        raise click.UsageError(f'got "{form}", expected {listed(FORMATS)}{guess(form, FORMATS)}')
    path = Path(tree)
    if (path / "record.mcap").is_file():
        drawing = app.draw_run(path, form)
    else:
        spec = load_tree(path if path.is_file() or "/" in tree else tree)
        drawing = draw(spec, form, usable_trees())
    content = drawing if isinstance(drawing, bytes) else drawing.encode()
    if output is not None:
        write_whole(output, content)
    else:
        click.echo(content, nl=False)
    return 0


@cli.command("import")
@click.argument("file", type=FILE)
@click.option("-o", "--output", type=FILE, default=Path("trees"), show_default=True, help="Where to write.")
@click.option("--force", is_flag=True, help="Replace files that are there already.")
def import_(file: Path, output: Path, force: bool) -> int:
    """Turn BehaviorTree.CPP v4 XML into tree files, one per tree; semantic differences are reported.

    Example: longarm import mission.xml -o trees
    """
    from executive.cli import importing

    imported = importing.import_file(file)
    for path in importing.write_trees(imported.trees, output, force):
        click.echo(path)
    for note in imported.notes:
        click.echo(f"{note.file}:{note.line}:{note.column}: note: {note.message}", err=True)
    return 0


@cli.command()
@click.argument("folder", metavar="DIR", type=FILE)
@click.option("--force", is_flag=True, help="Write into a folder that is not empty; replace files.")
@click.option("--schemas", is_flag=True, help="Only the editor's schemas of a project that is there, anew.")
def init(folder: Path, force: bool, schemas: bool) -> int:
    """Write a project that runs: a tree, a leaf, a strategy, a mission, a scenario, tests, editor settings.

    Example: longarm init my_rover
    """
    from executive.cli import starting

    if schemas:
        starting.refuse_unless_project(folder)
        files = starting.write_editor_files(folder)
    else:
        files = starting.write_project(folder, force)
    for file in files:
        click.echo(folder / file)
    if not schemas:
        click.echo(starting.next_commands(folder), nl=False)
    return 0


@cli.command()
@click.option("-o", "--output", type=FILE, default=Path("docs/reference"), show_default=True)
def reference(output: Path) -> int:
    """Write the reference from the declarations, those of plug-ins included: one Markdown page a subject.

    Example: longarm reference -o reference
    """
    from executive.cli.reference import write_pages

    for path in write_pages(output):
        click.echo(path)
    return 0


@cli.command()
@click.argument("kind")
def schema(kind: str) -> int:
    """Print the JSON Schema of a kind of file, for editors: tree, mission, scenario or campaign.

    Example: longarm schema tree > tree.schema.json
    """
    from executive.config.validate import guess, listed
    from executive.run import schema as schemas

    if kind not in schemas.kinds():
        raise click.UsageError(
            f'got "{kind}", expected {listed(schemas.kinds())}{guess(kind, schemas.kinds())}'
        )
    click.echo(json.dumps(schemas.schema(kind), indent=2, ensure_ascii=False))
    return 0
