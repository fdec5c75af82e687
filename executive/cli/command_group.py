"""A group of commands that also holds what plug-ins register under `longarm.commands`, loaded when asked for.

A dot in the name of an entry point puts a command into a group: `campaign.rerun` is `longarm campaign rerun`.
"""

from __future__ import annotations

from typing import Any

import click

from executive.core import registry
from executive.core.errors import PluginError
from executive.core.registry import Kind

COMMAND_KIND: Kind[click.Command] = Kind(
    "command",
    "commands",
    "A command of `longarm`.",
    click.Command,
    name_of=lambda command: None,  # campaign.run is called run
    page=lambda command: {"doc": (command.help or "").split("\n\n")[0]},
)


class CommandGroup(click.Group):
    """Its own commands, and every plug-in's whose name is `prefix` and one more word."""

    def __init__(self, *arguments: Any, prefix: str = "", **settings: Any) -> None:
        super().__init__(*arguments, **settings)
        self._prefix = prefix

    def list_commands(self, ctx: click.Context) -> list[str]:
        return sorted({*super().list_commands(ctx), *self._registered()})

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        own = super().get_command(ctx, cmd_name)
        if own is not None or cmd_name not in self._registered():
            return own
        try:
            command = registry.get(COMMAND_KIND, self._prefix + cmd_name)
        except PluginError as error:
            return _broken(cmd_name, error)
        return command

    def _registered(self) -> list[str]:
        names = [
            n.removeprefix(self._prefix) for n in registry.names(COMMAND_KIND) if n.startswith(self._prefix)
        ]
        return [name for name in names if "." not in name]


def _broken(name: str, error: PluginError) -> click.Command:
    """Stands in for a command that cannot be loaded, so that the help of the others still shows."""

    def fail(**_: object) -> None:
        raise error

    settings = {"ignore_unknown_options": True}
    rest = click.Argument(["rest"], nargs=-1, type=click.UNPROCESSED)
    return click.Command(name, context_settings=settings, callback=fail, params=[rest], help=str(error))
