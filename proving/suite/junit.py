"""The verdicts as JUnit XML, for CI.

Written with the standard library: pytest's own writer needs pytest's reports, and a few elements with two
attributes each do not need a dependency.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree as ET

from proving.judge.verdict import Word
from proving.suite.run import Tested

_ELEMENTS = {
    Word.EXPECTED_FAILURE: "skipped",
    Word.FAILED: "failure",
    Word.INVALID: "failure",
    Word.ERROR: "error",
}


def write_junit(path: Path, rows: Sequence[Tested]) -> None:
    """Write `<testsuites>` with one suite, a test case per scenario."""
    counts = Counter(_ELEMENTS.get(row.verdict.word) for row in rows)
    suite = ET.Element(
        "testsuite",
        name="longarm",
        tests=str(len(rows)),
        failures=str(counts["failure"]),
        errors=str(counts["error"]),
        skipped=str(counts["skipped"]),
        time=f"{sum(row.ending.wall_s for row in rows):.3f}",
    )
    for row in rows:
        suite.append(_case(row))
    root = ET.Element("testsuites")
    root.append(suite)
    ET.indent(root)
    path.parent.mkdir(parents=True, exist_ok=True)
    ET.ElementTree(root).write(path, encoding="utf-8", xml_declaration=True)


def _case(row: Tested) -> ET.Element:
    folder = str(row.collected.file.parent).replace("/", ".").strip(".")
    case = ET.Element(
        "testcase",
        classname=folder or "scenarios",
        name=row.collected.file.stem,
        file=str(row.collected.file),
        time=f"{row.ending.wall_s:.3f}",
    )
    element = _ELEMENTS.get(row.verdict.word)
    if element is not None:
        told = ET.SubElement(case, element, message=_legal(row.verdict.message), type=str(row.verdict.word))
        told.text = _legal(f"{row.verdict.message}\nrepeat: {row.repeat}\nrun folder: {row.folder}")
    return case


def _legal(text: str) -> str:
    """Without the characters that XML cannot hold."""
    return "".join(c for c in text if c in "\t\n" or ord(c) >= 0x20)
