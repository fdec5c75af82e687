"""The catalogue's commands, one a kind: `longarm strategies [NAME] [--json]`, made from the registry."""

from __future__ import annotations

import json
from typing import Any

import click

from executive.cli.command_group import CommandGroup
from executive.core import registry


class CatalogueGroup(CommandGroup):
    """The commands of `longarm`: its own, those of plug-ins, and a listing of every kind."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return sorted({*super().list_commands(ctx), *listings()})

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        command = super().get_command(ctx, cmd_name)
        return _listing(cmd_name) if command is None and cmd_name in listings() else command


def listings() -> tuple[str, ...]:
    """What can be listed: each kind by its plural, all nodes of a tree, all plug-ins."""
    return ("nodes", "plugins", *(name.replace("_", "-") for name in registry.kind_names()))


def _listing(listing: str) -> click.Command:
    words = listing.replace("-", " ")
    help = f"List the {words}, or one of them in full.\n\nExample: longarm {listing} --json"
    name = click.Argument(["name"], required=False)
    as_json = click.Option(["--json", "as_json"], is_flag=True, help="Print JSON.")

    def show(name: str | None, as_json: bool) -> int:
        return _show(listing, name, as_json)

    return click.Command(listing, callback=show, params=[name, as_json], help=help)


def _show(listing: str, name: str | None, as_json: bool) -> int:
    """Print it; what is broken is named on stderr, and is an error only where it is asked for."""
    from executive.run import catalogue

    entries, broken = catalogue.entries(listing), catalogue.broken(listing)
    if name is not None and name not in entries:
        _refuse(name, entries, broken)
    for each in broken if name is None else ():
        click.echo(f"longarm: cannot be used: {each}", err=True)
    chosen = entries if name is None else {name: entries[name]}
    if as_json:
        click.echo(json.dumps(chosen, indent=2, ensure_ascii=False))
    elif name is not None:
        click.echo(catalogue.as_text(name, chosen[name]), nl=False)
    else:
        width = max((len(entry) for entry in chosen), default=0)
        for entry, page in chosen.items():
            click.echo(f"{entry:{width}}  {page.get('doc', '')}".rstrip())
    return 0


def _refuse(name: str, entries: dict[str, Any], broken: tuple[registry.Broken, ...]) -> None:
    from executive.config.registered import not_loaded
    from executive.config.validate import guess, listed
    from executive.core.errors import PluginError

    for each in broken:
        if each.name == name:
            raise PluginError(str(each))
    known = sorted(entries)
    expected = listed(known) or "nothing"
    raise click.UsageError(f'got "{name}", expected {expected}{guess(name, known)}{not_loaded()}')
