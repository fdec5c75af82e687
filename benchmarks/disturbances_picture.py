"""What becomes of disturbed localisations over range, drawn for the docs from the rows of
benchmarks.disturbances."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib.pyplot as plt

if TYPE_CHECKING:
    from benchmarks.disturbances import Row

_HEIGHT, _WIDTH = 0.72, 0.94  # of a bar, in cells
_FALSE = "#c0392b"


def draw(rows: list[Row], path: Path) -> None:
    """A row a disturbance, a column a range, in each cell a bar of all its trials."""
    names = list(dict.fromkeys(row.name for row in rows))
    ranges = {row.range_m: row.pairs for row in rows}
    figure, axis = plt.subplots(figsize=(10, 0.36 * len(names) + 1.3), layout="constrained")
    for row in rows:
        left = list(ranges).index(row.range_m) - _WIDTH / 2
        for label, colour, count in _parts(row):
            width = _WIDTH * count / row.trials
            axis.barh(names.index(row.name), width, _HEIGHT, left, color=colour, label=label)
            left += width
        if row.false:  # too few to show as a bar, and what matters most
            place, around = (left - 0.03, names.index(row.name)), {"boxstyle": "round", "fc": "w", "lw": 0}
            axis.annotate(f"{row.false} false", place, ha="right", va="center", color=_FALSE, bbox=around)
    axis.set_xticks(
        range(len(ranges)), [f"{r:g} m\n{n} pair{'s' * (n > 1)}" for r, n in ranges.items()], fontsize=9
    )
    axis.set_yticks(range(len(names)), [name.replace("_", " ") for name in names])
    axis.set(xlim=(-0.5, len(ranges) - 0.5), ylim=(len(names) - 0.5, -0.5))
    axis.tick_params(length=0)
    axis.spines[:].set_visible(False)
    handles = dict(zip(*reversed(axis.get_legend_handles_labels()), strict=True))
    figure.legend(handles.values(), handles, loc="outside upper center", ncols=len(handles), frameon=False)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=130)


def _parts(row: Row) -> tuple[tuple[str, str, int], ...]:
    refused = row.trials - row.detected
    return (
        ("located", "#2f7ebc", row.detected - row.false),
        ("refused, with what is wrong or the truth as reason", "#c9d3dc", row.right),
        ("refused for another reason", "#e8a33d", refused - row.right),
        ("false", _FALSE, row.false),
    )
