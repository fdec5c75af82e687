"""`longarm check`: which kind of file it is, and every problem in it and in what it refers to."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from executive.config.file_kinds import file_kind, file_kinds
from executive.config.find import shown
from executive.config.project import project_for, read_project
from executive.config.source import read
from executive.config.validate import guess, listed
from executive.core.errors import ConfigError, Problem
from executive.core.registry import PROJECT_FILE, in_project
from executive.run.resolve import as_scenario, resolve
from executive.tree.load import load_tree

OWN = ("tree", "mission", "scenario")


def check_file(path: Path) -> tuple[Problem, ...]:
    """Every problem of one file; none is an empty tuple."""
    try:
        if path.name == PROJECT_FILE:
            read_project(path)
            return ()
        with in_project(project_for(path)):
            return _problems(path)
    except ConfigError as error:
        return error.problems


def _problems(path: Path) -> tuple[Problem, ...]:
    source = read(path, shown(path))
    kind = kind_of(source.data)
    if kind is None:
        keys = [str(key) for key in source.data] if isinstance(source.data, dict) else []
        known = (*file_kinds(), *OWN)
        near = next((text for key in keys if (text := guess(key, known))), "")
        message = f"got a file of no known kind, expected one of the keys {listed(known)}{near}"
        return tuple(sorted({*source.problems, source.at(()).problem(message)}))
    if kind == "tree":
        load_tree(path)
    elif kind in file_kinds():
        file_kind(kind).check(source)
    else:
        resolve(as_scenario(source))
    return ()


def kind_of(data: Any) -> str | None:
    """Tree, mission, scenario, or a kind that a plug-in reads, by the key that names the file."""
    if not isinstance(data, dict):
        return None
    if "tree" in data and "root" in data:
        return "tree"
    return next((kind for kind in (*file_kinds(), "scenario", "mission", "tree") if kind in data), None)


def as_text(problems: Sequence[Problem]) -> str:
    """One line a problem, as compilers write it."""
    return "".join(f"{problem}\n" for problem in problems)


def as_json(problems: Sequence[Problem]) -> str:
    """A list of objects."""
    listing = [{"file": p.file, "line": p.line, "column": p.column, "message": p.message} for p in problems]
    return json.dumps({"problems": listing}, indent=2, ensure_ascii=False) + "\n"


def as_sarif(problems: Sequence[Problem]) -> str:
    """SARIF 2.1.0, which code hosts show beside the lines."""
    results = [
        {
            "ruleId": "configuration",
            "level": "error",
            "message": {"text": p.message},
            "locations": [
                {
                    "physicalLocation": {
                        "artifactLocation": {"uri": p.file},
                        "region": {"startLine": p.line, "startColumn": p.column},
                    }
                }
            ],
        }
        for p in problems
    ]
    rule = {"id": "configuration", "shortDescription": {"text": "The file cannot be used as it is."}}
    run = {"tool": {"driver": {"name": "longarm", "rules": [rule]}}, "results": results}
    document = {
        "$schema": "https://json.schemastore.org/sarif-2.1.0.json",
        "version": "2.1.0",
        "runs": [run],
    }
    return json.dumps(document, indent=2, ensure_ascii=False) + "\n"


def written(problems: Sequence[Problem], form: str) -> str:
    """The problems as text, json or sarif."""
    return {"text": as_text, "json": as_json, "sarif": as_sarif}[form](problems)
