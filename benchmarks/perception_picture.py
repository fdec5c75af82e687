"""Error and bound over range, drawn for the docs from the rows of benchmarks.perception."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib.pyplot as plt
import numpy as np

if TYPE_CHECKING:
    from benchmarks.perception import Row

_MARKS = {"ideal": ("o-", "tab:blue", "still frames"), "real": ("s--", "tab:orange", "frames of the field")}


def draw(tables: dict[str, list[Row]], path: Path) -> None:
    """Two log-log axes, position and yaw, a line a table over the band of the bound."""
    figure, axes = plt.subplots(1, 2, figsize=(10, 4), layout="constrained")
    for axis, name, suffix, unit, scale in (
        (axes[0], "position", "m", "mm", 1e3),
        (axes[1], "yaw", "rad", "deg", float(np.degrees(1.0))),
    ):
        rows = next(iter(tables.values()))
        ranges = [row.range_m for row in rows]
        bound = [scale * getattr(row, f"{name}_bound_{suffix}") for row in rows]
        axis.loglog(ranges, bound, color="0.75", lw=7, solid_capstyle="round", label="Cramér–Rao bound")
        for table, lines in tables.items():
            style, colour, label = _MARKS[table]
            error = [scale * getattr(row, f"{name}_{suffix}") for row in lines]
            there = [row.range_m for row in lines]
            axis.loglog(there, error, style, color=colour, label=f"RMS error, {label}")
        axis.set_xticks(ranges, [f"{row.range_m:g}\n{row.demand.pairs}" for row in rows], fontsize=9)
        axis.minorticks_off()
        axis.set(
            xlabel="range [m], and below it the pairs N of each LED",
            ylabel=f"{name} [{unit}]",
            title=name.capitalize(),
        )
        axis.margins(x=0.1, y=0.1)
        axis.grid(alpha=0.3)
        axis.legend()
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=130)
