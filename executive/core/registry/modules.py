"""Plug-in modules: files that a project names and modules of packages, scanned for what they define."""

from __future__ import annotations

import ast
import hashlib
import importlib.util
import inspect
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

from executive.core.registry.kind import Kind

added_to_path: set[str] = set()
"""Folders of plug-in files, at the end of `sys.path` so that they hide nothing."""


def load_file(path: Path) -> ModuleType:
    """Import a file under a private name, once a process; raises whatever that raises.

    What lies beside it can be imported relatively (`from . import helpers`), or by name if nothing else
    of that name is there.
    """
    package = _package(path.parent)
    name = f"{package}.{path.stem}"
    if name in sys.modules:  # perhaps still under way: a plug-in that looks up what it has defined so far
        return sys.modules[name]
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise ImportError("not a Python file")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except BaseException:
        sys.modules.pop(name, None)
        raise
    return module


def _package(folder: Path) -> str:
    """A package of this folder's own, so that equal file names of two projects never meet."""
    name = f"longarm_plugins_{hashlib.sha256(str(folder).encode()).hexdigest()[:12]}"
    if name not in sys.modules:
        package = ModuleType(name)
        package.__path__ = [str(folder)]
        sys.modules[name] = package
    if str(folder) not in sys.path:
        sys.path.append(str(folder))
        added_to_path.add(str(folder))
    return name


def defined_in(module: ModuleType, kinds: Iterable[Kind[Any]]) -> Iterator[tuple[Kind[Any], str, object]]:
    """What a module adds: (kind, name, thing) of each that it defines or lists in `__all__`."""
    kinds = tuple(kinds)
    for attribute in _own_names(module):
        thing = getattr(module, attribute, None)
        for kind in kinds:
            if kind.scanned and kind.fits(thing) and not inspect.isabstract(thing):
                yield kind, kind.name_of(thing) or attribute.lower(), thing


def _own_names(module: ModuleType) -> tuple[str, ...]:
    """Public names that the module itself binds, in order; `__all__` where it has one."""
    listed = getattr(module, "__all__", None)
    if listed is not None:
        return tuple(listed)
    names = dict.fromkeys(_bound(ast.parse(inspect.getsource(module)).body))
    return tuple(name for name in names if not name.startswith("_"))


def _bound(body: Iterable[ast.stmt]) -> Iterator[str]:
    """Names that statements bind other than by import; the bodies of functions and classes are their own."""
    for statement in body:
        if isinstance(statement, ast.ClassDef | ast.FunctionDef):
            yield statement.name
        elif isinstance(statement, ast.Assign | ast.AnnAssign):
            targets = statement.targets if isinstance(statement, ast.Assign) else [statement.target]
            yield from (node.id for t in targets for node in ast.walk(t) if isinstance(node, ast.Name))
        for inner in ("body", "orelse", "handlers", "finalbody"):
            if not isinstance(statement, ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
                yield from _bound(getattr(statement, inner, ()))
