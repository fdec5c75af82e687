"""Coverage as text for people, and as data."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import groupby
from typing import Any

from executive.report.figure import counted
from proving.coverage.coverage import Coverage, Share

PLURALS = {
    "node": "node outcomes",
    "strategy": "strategies",
    "phase": "phases",
    "fault": "faults",
    "hypothesis": "hypotheses",
}


def as_text(coverage: Coverage) -> str:
    """A summary a kind, then the holes, node by node."""
    return "\n".join([*_summary(coverage), *_holes(coverage), *_oddities(coverage), ""])


def headline(coverage: Coverage) -> str:
    """One line."""
    runs = len(coverage.seen.runs)
    return f"coverage {_share(coverage.share())} by {runs} run{'s' if runs != 1 else ''}"


def as_data(coverage: Coverage) -> dict[str, Any]:
    """Everything, for `--json`."""
    return {
        "runs": coverage.seen.runs,
        "total": _share_data(coverage.share()),
        "kinds": {kind: _share_data(share) for kind, share in coverage.shares().items()},
        "items": [
            {
                "kind": item.kind,
                "name": item.name,
                "outcome": item.word,
                "count": coverage.seen.count[item],
                "first": coverage.seen.first.get(item),
                "excused": coverage.excused.get(item),
            }
            for item in coverage.items
        ],
        "undeclared": [
            {"node": item.name, "reason": item.word, "count": count}
            for item, count in sorted(coverage.seen.undeclared.items())
        ],
        "problems": [str(problem) for problem in coverage.problems],
    }


def _summary(coverage: Coverage) -> Iterator[str]:
    yield headline(coverage)
    for kind, share in coverage.shares().items():
        yield f"  {PLURALS[kind]:14} {_share(share)}"


def _share(share: Share) -> str:
    excused = f", {share.excused} excused" if share.excused else ""
    return f"{share.ratio:5.1%} ({share.covered} of {share.of}{excused})"


def _share_data(share: Share) -> dict[str, float]:
    return {"covered": share.covered, "of": share.of, "excused": share.excused, "ratio": share.ratio}


def _holes(coverage: Coverage) -> Iterator[str]:
    holes = coverage.holes()
    if not holes:
        return
    yield "not seen:"
    width = min(max(len(item.name) for item in holes), 76)
    for (kind, name), items in groupby(holes, lambda item: (item.kind, item.name)):
        words = ", ".join(item.word for item in items)
        yield f"  {kind:10} {name:{width}}  {words}"


def _oddities(coverage: Coverage) -> Iterator[str]:
    for item, count in sorted(coverage.seen.undeclared.items()):
        yield f"not declared: {item.name} failed with {item.word}, {counted(count, 'time')}"
    if strangers := coverage.seen.strangers:
        yield f"not in the trees as they are now: {len(strangers)} nodes, such as {min(strangers)}"
