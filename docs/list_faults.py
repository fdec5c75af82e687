"""Writes docs/faults.md, the catalogue of every installed fault. Run it when one changes; a test says when.

python docs/list_faults.py
"""

from __future__ import annotations

from itertools import groupby
from pathlib import Path
from typing import Any

from executive.run.catalogue import entries
from executive.run.fault import CATEGORIES

PAGE = Path(__file__).parent / "faults.md"

HEAD = """\
# Faults

The faults that a scenario can inject, generated from their declarations (`python docs/list_faults.py`).
`longarm faults NAME` prints one of them, third-party plug-ins included; `longarm schema scenario` gives
editors all of them. Onsets (`from`), durations (`for`), profiles and groups: see the
[tutorial](tutorials/3-a-scenario-with-faults.md).

The record has three entries for a fault: when its onset came, when it first altered anything, and when it
ended. A fault that never altered anything makes the run `invalid`.
"""


def page() -> str:
    """The whole page."""
    faults = entries("faults")
    by_category = sorted(faults, key=lambda name: (CATEGORIES.index(faults[name]["category"]), name))
    parts = [HEAD]
    for category, names in groupby(by_category, key=lambda name: faults[name]["category"]):
        parts.append(f"## {category.capitalize()}\n")
        parts += [_entry(name, faults[name]) for name in names]
    return "\n".join(parts)


def _entry(name: str, fault: dict[str, Any]) -> str:
    lines = [f"### `{name}`\n", f"{fault['doc']}\n"]
    if fault["parameters"]:
        lines += ["| parameter | is | default | |", "|---|---|---|---|"]
        lines += [_row(parameter) for parameter in fault["parameters"]]
        lines.append("")
    lines.append(f"{_facts(fault)}\n")
    return "\n".join(lines)


def _row(parameter: dict[str, Any]) -> str:
    default = "required" if parameter["required"] else f"`{parameter['default']}`"
    default = "none" if parameter["default"] is None and not parameter["required"] else default
    return f"| `{parameter['name']}` | {parameter['kind']} | {default} | {parameter['doc']} |"


def _facts(fault: dict[str, Any]) -> str:
    facts = [f"Profiles: {', '.join(fault['profiles'])}"]
    facts += ["cannot be taken back"] if fault["lasting"] else []
    facts.append(f"tiers: {', '.join(fault['tiers']) or 'any'}")
    facts.append(f"backends: {', '.join(fault['backends']) or 'any'}")
    facts.append(f"should be diagnosed as: {fault['hypothesis'] or 'nothing'}")
    return "; ".join(facts) + "."


if __name__ == "__main__":
    PAGE.write_text(page())
