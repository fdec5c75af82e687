"""`longarm init`: a project that runs, copied from a template, with schemas for the editor made for it."""

from __future__ import annotations

import json
import shutil
import tempfile
from pathlib import Path
from typing import Any

from executive.config.find import INSTALLED
from executive.config.project import project_for
from executive.core.errors import LongarmError
from executive.core.files import write_whole
from executive.core.registry import PROJECT_FILE, in_project
from executive.run import schema as schemas

TEMPLATE = INSTALLED / "templates" / "project"
RENAMED = {"gitignore": ".gitignore"}  # so that the template's own is not taken for this repository's
SCHEMAS = Path(".vscode", "schemas")
NEXT = """
Next:
  cd {folder}
  longarm check longarm.yaml trees/*.yaml missions/*.yaml scenarios/*.yaml
  longarm run scenarios/hidden_markers.yaml --out runs/first     # writes runs/first/report.html
  longarm test scenarios                                         # the scenario as a test
  pytest                                                         # the same, and the tests in Python
"""
EXTENSIONS = ("redhat.vscode-yaml", "ms-python.python")


def write_project(folder: Path, force: bool = False) -> tuple[Path, ...]:
    """Write a project into an absent or empty folder; the files, relative to it.

    With `force` the folder may hold other files; those of the same name are replaced. LongarmError where it
    may not be written to, and then nothing is.
    """
    refuse_unless_free(folder, force)
    with tempfile.TemporaryDirectory(prefix="longarm-init-") as scratch:
        made = Path(scratch, "project")
        shutil.copytree(TEMPLATE, made, ignore=shutil.ignore_patterns("__pycache__"))
        for name, its_name in RENAMED.items():
            (made / name).rename(made / its_name)
        write_editor_files(made)
        files = tuple(sorted(path.relative_to(made) for path in _files(made)))
        try:
            shutil.copytree(made, folder, dirs_exist_ok=True, ignore=shutil.ignore_patterns("__pycache__"))
        except OSError as error:
            raise LongarmError(f"{folder}: cannot be written to: {error}") from error
    return files


def refuse_unless_free(folder: Path, force: bool) -> None:
    """LongarmError for a file, and without `force` for a folder with anything in it."""
    if folder.exists() and not folder.is_dir():
        raise LongarmError(f"{folder}: got a file, expected a folder, empty or not there yet")
    if folder.is_dir() and any(folder.iterdir()) and not force:
        message = "got a folder with files in it, expected an empty one or none"
        raise LongarmError(f"{folder}: {message}; --force writes into it and replaces files of the same name")


def refuse_unless_project(folder: Path) -> None:
    """LongarmError where the folder has no project file."""
    if not (folder / PROJECT_FILE).is_file():
        raise LongarmError(f"{folder}: got no {PROJECT_FILE}, expected the folder of a project")


def next_commands(folder: Path) -> str:
    """What to type next, as the last lines of `init`."""
    return NEXT.format(folder=folder)


def write_editor_files(folder: Path) -> tuple[Path, ...]:
    """Write `.vscode/` for the project in this folder, its plug-ins known; the files, relative to it."""
    with in_project(project_for(folder / PROJECT_FILE)):
        made = {SCHEMAS / f"{kind}.json": schemas.schema(kind) for kind in schemas.kinds()}
    made[Path(".vscode", "settings.json")] = _settings()
    made[Path(".vscode", "extensions.json")] = {"recommendations": list(EXTENSIONS)}
    for path, content in made.items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        write_whole(folder / path, json.dumps(content, indent=2, ensure_ascii=False) + "\n")
    return tuple(sorted(made))


def _settings() -> dict[str, Any]:
    return {
        "yaml.schemas": {f"./{SCHEMAS}/{kind}.json": _where(kind) for kind in schemas.kinds()},
        "python.testing.pytestEnabled": True,
    }


def _where(kind: str) -> list[str]:
    """The files of a kind: those in the folder of its name, and the one project file."""
    return [PROJECT_FILE] if kind == "project" else [f"{kind}s/**/*.yaml", f"{kind}s/**/*.yml"]


def _files(folder: Path) -> list[Path]:
    return [path for path in folder.rglob("*") if path.is_file() and "__pycache__" not in path.parts]
