"""The project under way: the user's own plug-in files and folders, as `longarm.yaml` names them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from pathlib import Path


@dataclass(frozen=True)
class Project:
    """A `longarm.yaml`, read: plug-in files and folders by absolute path, defaults of scenarios."""

    file: Path
    plugins: tuple[Path, ...] = ()
    paths: tuple[Path, ...] = ()
    defaults: Mapping[str, str | int] = field(default_factory=dict, hash=False)

    def title(self, plugin: Path) -> str:
        """How messages name one of its plug-in files: `longarm.yaml: leaves.py`."""
        folder = self.file.parent
        shown = plugin.relative_to(folder) if plugin.is_relative_to(folder) else plugin
        return f"{self.file.name}: {shown}"


PROJECT_FILE = "longarm.yaml"


def project_file(folder: Path) -> Path | None:
    """The nearest project file in this folder or above it."""
    folder = folder.absolute()
    return next((file for at in (folder, *folder.parents) if (file := at / PROJECT_FILE).is_file()), None)


_UNDER_WAY: ContextVar[Project | None] = ContextVar("project", default=None)


def current_project() -> Project | None:
    """The project whose plug-ins count just now."""
    return _UNDER_WAY.get()


@contextmanager
def in_project(project: Project | None) -> Iterator[None]:
    """Within this block the plug-ins of this project count, and those of no other."""
    token = _UNDER_WAY.set(project)
    try:
        yield
    finally:
        _UNDER_WAY.reset(token)
