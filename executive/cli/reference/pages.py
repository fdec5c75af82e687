"""Every page of the reference, by file name."""

from __future__ import annotations

from pathlib import Path

from executive.cli.reference.files import backend_page, file_pages
from executive.cli.reference.prose import prose
from executive.cli.reference.record import record_page, result_page
from executive.cli.reference.tree import nodes_page, tree_page
from executive.config.backends import BACKEND_KIND
from executive.core import registry
from executive.core.files import write_whole

MARK = "<!-- Made by `longarm reference`; change the declarations, not this page. -->\n"


def pages() -> dict[str, str]:
    """File name → Markdown. Plug-ins of the project under way are in it."""
    made = {
        "tree.md": tree_page(),
        "nodes.md": nodes_page(),
        **file_pages(),
        **{f"backend-{name}.md": backend_page(name) for name in registry.every(BACKEND_KIND)},
        "result.md": result_page(),
        "record.md": record_page(),
        "exit-codes.md": prose("exit-codes"),
    }
    made["README.md"] = _contents(made)
    return {name: MARK + text.rstrip("\n") + "\n" for name, text in sorted(made.items())}


def write_pages(folder: Path) -> tuple[Path, ...]:
    """Write them all into a folder, which is made where it is not there."""
    folder.mkdir(parents=True, exist_ok=True)
    written = [(folder / name, text) for name, text in pages().items()]
    for path, text in written:
        write_whole(path, text)
    return tuple(path for path, _ in written)


def _contents(made: dict[str, str]) -> str:
    lines = ["# Reference\n", "| page | is |", "|---|---|"]
    for name, text in made.items():
        title, _, rest = text.removeprefix("# ").partition("\n")
        first = rest.strip().split("\n\n")[0].replace("\n", " ")
        lines.append(f"| [{title}]({name}) | {first} |")
    more = (
        "\nFaults, expectations and campaigns have pages of their own that tell more: "
        "[faults](../faults.md), [expectations](../expectations.md), [campaigns](../campaigns.md). "
        "`longarm KIND [NAME]` prints what there is of each kind, plug-ins included; `longarm schema` gives "
        "editors the same.\n"
    )
    return "\n".join(lines) + "\n" + more
