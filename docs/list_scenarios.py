"""Writes scenarios/README.md, what each scenario teaches. Run it when one changes; a test says when.

python docs/list_scenarios.py
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import groupby, takewhile
from pathlib import Path

from executive.config.source import read

SCENARIOS = Path(__file__).parents[1] / "scenarios"
PAGE = SCENARIOS / "README.md"

HEAD = """\
# Scenarios

Files to learn from, and the suite that every change must pass: `longarm test scenarios -j 2`, or
`pytest scenarios/ -n 2`. One is run by itself with `longarm run` and its file, and told about afterwards by
`longarm explain` and its run folder. Every fault of the catalogue (`longarm faults`) comes in at least one of
them, and takes effect there. All keep the rover safe: never beyond the off-track margin, within the limits
of tilt and tether, at rest at the end.

*Expected to fail* are those of which the executive should make more than it does yet. That verdict is strict:
once it does, the mark must go.

This page is written by `python docs/list_scenarios.py` from the first lines of the files.
"""
TITLES = {
    ".": "To begin with",
    "onsets": "When a fault begins",
    "profiles": "How strong a fault is",
    "several": "Several faults at once",
}
FIRST, LAST = (".",), ("onsets", "profiles", "several")


def page() -> str:
    """The whole page: a table for each folder."""
    parts = [HEAD]
    for folder, files in groupby(sorted(SCENARIOS.rglob("*.yaml"), key=_place), key=_folder):
        parts += [
            f"## {TITLES.get(folder, folder.capitalize())}\n",
            "| file | teaches | verdict |",
            "|---|---|---|",
        ]
        parts += [*map(_row, files), ""]
    return "\n".join(parts)


def _folder(file: Path) -> str:
    return str(file.parent.relative_to(SCENARIOS))


def _place(file: Path) -> tuple[int, str, str]:
    folder = _folder(file)
    return (folder in LAST) - (folder in FIRST), folder, file.stem


def _row(file: Path) -> str:
    why = read(file, file.name).data.get("expected_to_fail")
    verdict = f"expected to fail: {why}" if why else "passes"
    return f"| [`{file.stem}`]({file.relative_to(SCENARIOS)}) | {lesson(file)} | {verdict} |"


def lesson(file: Path) -> str:
    """The comment at the head of a scenario: what its reader learns."""
    return " ".join(_comment(file.read_text(encoding="utf-8")))


def _comment(text: str) -> Iterator[str]:
    for line in takewhile(lambda line: line.startswith("#"), text.splitlines()):
        yield line.lstrip("# ")


if __name__ == "__main__":
    PAGE.write_text(page())
