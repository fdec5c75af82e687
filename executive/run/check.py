"""`longarm check`: which kind of file it is, and every problem in it and in what it refers to."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

from executive.config.file_kinds import file_kind, file_kinds, kind_of
from executive.config.find import shown
from executive.config.project import project_for, project_source
from executive.config.source import read
from executive.config.validate import guess, listed
from executive.core.errors import ConfigError, Problem
from executive.core.registry import PROJECT_FILE, in_project
from executive.run.resolved import ResolvedScenario


def check_file(path: Path) -> tuple[Problem, ...]:
    """Every problem of one file, or else every warning; none is an empty tuple."""
    try:
        with in_project(project_for(path)):
            return _problems(path)
    except ConfigError as error:
        return error.problems


def _problems(path: Path) -> tuple[Problem, ...]:
    if path.name == PROJECT_FILE:  # told by its name, since all its keys may be left out
        file_kind("project").check(project_source(path))
        return ()
    source = read(path, shown(path))
    kind = kind_of(source.data)
    if kind is None:
        keys = [str(key) for key in source.data] if isinstance(source.data, dict) else []
        known = file_kinds()
        near = next((text for key in keys if (text := guess(key, known))), "")
        message = f"got a file of no known kind, expected one of the keys {listed(known)}{near}"
        return tuple(sorted({*source.problems, source.at(()).problem(message)}))
    found = file_kind(kind).check(source)
    return found.warnings if isinstance(found, ResolvedScenario) else ()


def as_text(problems: Sequence[Problem]) -> str:
    """One line a problem, as compilers write it."""
    return "".join(f"{problem}\n" for problem in problems)


def _severity(problem: Problem) -> str:
    return "warning" if problem.warning else "error"


def as_json(problems: Sequence[Problem]) -> str:
    """A list of objects."""
    listing = [
        {
            "file": p.file,
            "line": p.line,
            "column": p.column,
            "message": p.message,
            "severity": _severity(p),
        }
        for p in problems
    ]
    return json.dumps({"problems": listing}, indent=2, ensure_ascii=False) + "\n"


def as_sarif(problems: Sequence[Problem]) -> str:
    """SARIF 2.1.0, which code hosts show beside the lines."""
    results = [
        {
            "ruleId": "configuration",
            "level": _severity(p),
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
