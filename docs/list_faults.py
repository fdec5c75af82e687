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

What can be injected into a scenario, told by the faults' own declarations (`python docs/list_faults.py`).
`longarm faults NAME` tells the same of one, third-party plug-ins included; `longarm schema scenario` gives
editors all of it. Onsets (`from`), durations (`for`), profiles and groups: see the
[tutorial](tutorials/3-a-scenario-with-faults.md).

A fault is in the record three times: when its onset came, when it first altered anything, and when it was
over. One that never altered anything makes the run `invalid`.
"""


def page() -> str:
    """The whole page."""
    told = entries("faults")
    by_category = sorted(told, key=lambda name: (CATEGORIES.index(told[name]["category"]), name))
    parts = [HEAD]
    for category, names in groupby(by_category, key=lambda name: told[name]["category"]):
        parts.append(f"## {category.capitalize()}\n")
        parts += [_entry(name, told[name]) for name in names]
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
