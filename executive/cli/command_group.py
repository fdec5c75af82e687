"""A group of commands that also holds what plug-ins register under `longarm.commands`, loaded when asked for.

A dot in the name of an entry point puts a command into a group: `campaign.rerun` is `longarm campaign rerun`.
"""

from __future__ import annotations

from typing import Any

import click

from executive.core import plugins
from executive.core.errors import PluginError


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
            command = plugins.load(plugins.COMMANDS, self._prefix + cmd_name, click.Command)
        except PluginError as error:
            return _broken(cmd_name, error)
        return command if isinstance(command, click.Command) else None

    def _registered(self) -> list[str]:
        names = [
            n.removeprefix(self._prefix)
            for n in plugins.found(plugins.COMMANDS)
            if n.startswith(self._prefix)
        ]
        return [name for name in names if "." not in name]


def _broken(name: str, error: PluginError) -> click.Command:
    """Stands in for a command that cannot be loaded, so that the help of the others still shows."""

    def fail(**_: object) -> None:
        raise error

    settings = {"ignore_unknown_options": True}
    rest = click.Argument(["rest"], nargs=-1, type=click.UNPROCESSED)
    return click.Command(name, context_settings=settings, callback=fail, params=[rest], help=str(error))
