"""A working folder with a scenario whose fault and backend come from a plug-in of its own."""

from tests.executive.config.conftest import folder, plugin

__all__ = ["folder", "plugin"]
