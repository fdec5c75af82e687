"""Where a file reference leads: a path seen from the referring file, or a bare name in known folders."""

from __future__ import annotations

from pathlib import Path

import executive
from executive.config.source import Mark
from executive.config.validate import guess
from executive.core.errors import ConfigError

INSTALLED = Path(executive.__file__).parent.parent
SUFFIXES = ("", ".yaml", ".yml")


def find(kind: str, reference: str, folder: Path, mark: Mark, working: Path | None = None) -> Path:
    """The file that `reference` names; ConfigError at `mark` when there is none.

    `kind` is the folder of bare names: trees, missions, scenarios or campaigns, with all folders inside it;
    those of the working folder come before the installed ones. Anything with a slash or a suffix is tried as
    a path first.
    """
    working = working if working is not None else Path.cwd()
    candidates = [folder / reference] if _is_path(reference) else []
    if "/" not in reference:
        folders = [inner for root in (working, INSTALLED) for inner in _folders(root / kind)]
        candidates += [inner / f"{reference}{suffix}" for inner in folders for suffix in SUFFIXES]
    if not reference.isprintable() or not reference:
        raise ConfigError([mark.problem(f"got {reference!r}, expected the name of a file in {kind}/")])
    for candidate in candidates:
        if _is_file(candidate):
            return candidate.absolute()
    known = names(kind, working)
    message = f'got "{reference}", expected a file or a name in {kind}/{guess(reference, known)}'
    raise ConfigError([mark.problem(message)])


def names(kind: str, working: Path | None = None) -> list[str]:
    """The bare names there are, sorted."""
    roots = (working if working is not None else Path.cwd(), INSTALLED)
    return sorted({path.stem for root in roots for path in (root / kind).rglob("*.y*ml")})


def portable(kind: str, path: Path) -> str:
    """How a resolved configuration names this file: the bare name of an installed one, else its full path."""
    installed = path.is_relative_to(INSTALLED / kind)
    return path.stem if installed and path.suffix == ".yaml" else str(path)


def shown(path: Path) -> str:
    """A path as messages show it: relative to the working folder where it lies inside."""
    working = Path.cwd()
    return str(path.relative_to(working)) if path.is_relative_to(working) else str(path)


def _folders(root: Path) -> list[Path]:
    """The folder and all inside it, in order; the nearest come first."""
    inner = (path for path in root.rglob("*") if path.is_dir() and not path.name.startswith((".", "__")))
    return [root, *sorted(inner, key=lambda path: (len(path.parts), path))]


def _is_path(reference: str) -> bool:
    return "/" in reference or reference.endswith((".yaml", ".yml"))


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except OSError:  # a name too long for the file system
        return False
