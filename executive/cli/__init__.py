"""The `longarm` command."""

from executive.cli.command_line import cli, invoke, main

__all__ = ["cli", "invoke", "main"]
