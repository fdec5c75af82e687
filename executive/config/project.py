"""The project file `longarm.yaml`, beside one's own files or above them.

paths: [lib]              # folders in which bare names are looked up, seen from this file
plugins: [leaves.py]      # Python files with leaves, strategies, faults, ...
defaults: {tier: geometric, backend: fake}      # what a scenario has that does not say
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Annotated

from pydantic import Field

from executive.config.models import Name
from executive.config.source import Mark, Source, read
from executive.config.validate import Problems, Strict, parse
from executive.core.errors import ConfigError
from executive.core.registry import PROJECT_FILE, Project, current_project, project_file

Relative = Annotated[str, Field(min_length=1)]


class Defaults(Strict):
    """What a scenario has that does not say otherwise."""

    tier: Name | None = None
    backend: Name | None = None
    localizer: Name | None = None
    seed: Annotated[int, Field(ge=0, lt=2**63)] | None = None


class ProjectFile(Strict):
    """A project: one's own plug-ins, folders and defaults; every file is seen from this one."""

    paths: tuple[Relative, ...] = ()
    plugins: tuple[Relative, ...] = ()
    defaults: Defaults = Defaults()


def project_for(path: Path) -> Project | None:
    """The project beside a file or folder or above it, else that under way, else the working folder's."""
    folder = path if path.is_dir() else path.parent
    return project_above(folder) or current_project() or project_above(Path.cwd())


def project_above(folder: Path) -> Project | None:
    """The nearest project file in this folder or above it, read; ConfigError with what is wrong in it."""
    file = project_file(folder)
    return read_project(file) if file is not None else None


def read_project(file: Path) -> Project:
    """A project file; ConfigError with every problem."""
    return project_in(project_source(file), file.name)


def project_in(source: Source, name: str = PROJECT_FILE) -> Project:
    """The same from a file of this name already read."""
    problems = Problems()
    parsed = problems.attempt(parse, source, ProjectFile)
    data = source.data if isinstance(source.data, dict) else {}
    plugins = _files(source, problems, "plugins", data.get("plugins"), Path.is_file, "a Python file")
    paths = _files(source, problems, "paths", data.get("paths"), Path.is_dir, "a folder")
    problems.check()
    assert parsed is not None  # noqa: S101  (else a problem was found)
    file = (source.folder() / name).absolute()
    return Project(file, plugins, paths, parsed.defaults.model_dump(exclude_none=True))


def with_defaults(source: Source, project: Project | None) -> Source:
    """A scenario with the project's defaults where it does not say; each keeps its place in that file."""
    if project is None or not project.defaults or not isinstance(source.data, dict):
        return source
    defaults = project_source(project.file)
    for key in project.defaults:
        if key not in source.data:
            source = source.graft((key,), defaults.part(("defaults", key)))
    return source


def project_source(file: Path) -> Source:
    """A project file as it stands; an empty one is a project too."""
    working = Path.cwd()
    name = str(file.relative_to(working)) if file.is_relative_to(working) else str(file)
    if not any(line.partition("#")[0].strip() for line in file.read_text(errors="replace").splitlines()):
        return Source({}, {(): Mark(name, 1, 1)}, folders={(): file.parent})  # its place alone says enough
    return read(file, name)


def _files(
    source: Source, problems: Problems, key: str, names: object, there: Callable[[Path], bool], what: str
) -> tuple[Path, ...]:
    """The files or folders that a list names, seen from the project file; a problem for each not there."""
    found = []
    for index, name in enumerate(names if isinstance(names, list) else ()):
        path = source.folder() / name if isinstance(name, str) else None
        if path is not None and there(path) and (key != "plugins" or path.suffix == ".py"):
            found.append(path.absolute())
        elif path is not None:
            problems.add(source.at((key, index)).problem(f'got "{name}", expected {what} beside this file'))
    return tuple(found)


def named_project(source: Source) -> Project | None:
    """The project that a scenario names itself under `project`, else that of its folder."""
    named = source.data.get("project") if isinstance(source.data, dict) else None
    if isinstance(named, str):
        file = source.folder(("project",)) / named
        if not file.is_file():
            message = f'got "{named}", expected a project file: {file} is not there'
            raise ConfigError([source.at(("project",)).problem(message)])
        return read_project(file)
    return project_for(source.folder()) if () in source.folders else current_project()
