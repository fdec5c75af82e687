"""What no declaration says: pages written by hand, and examples, from the files beside this one."""

from __future__ import annotations

from functools import cache
from importlib.resources import files
from typing import Any

import yaml


@cache
def prose(name: str) -> str:
    """The hand-written part of a page."""
    return files("executive.cli.reference").joinpath(f"{name}.md").read_text()


@cache
def examples(name: str) -> Any:
    """Examples: `nodes` (node → root of a tree), `expressions`, `files` (kind → about, example)."""
    return yaml.safe_load(files("executive.cli.reference").joinpath(f"{name}.yaml").read_text())
