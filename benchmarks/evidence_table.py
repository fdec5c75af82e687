"""What the search for unsafe evidence found so far: counts by fault and extent, with their intervals."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass

from proving.campaign.interval import wilson


@dataclass(frozen=True)
class Row:
    """One run and how it ended.

    `nearest_m` is how far from leaving the corridor the rover truly was when nearest to it, negative beyond;
    `beyond_m` the way truly driven beyond. `unsafe` names the safety rows that were not met, `false_m` is by
    how much the worst way-point that was declared reached lies outside of its tolerance, 0 if none does.
    """

    key: str
    fault: str
    extent: str
    mission: str
    seed: int
    outcome: str
    reason: str | None
    fired: bool
    mid_remedy: bool
    """Whether the fault ended while a remedy was under way."""
    beyond_m: float
    nearest_m: float | None
    false_m: float
    unsafe: tuple[str, ...]
    cause: str = ""
    """Why there is no proper end: crash, hang, error, refused; nothing where there is one."""
    wall_s: float = 0.0

    def to_json(self) -> dict[str, object]:
        return asdict(self)

    @classmethod
    def from_json(cls, data: dict[str, object]) -> Row:
        return cls(**data | {"unsafe": tuple(data["unsafe"])})


def table(rows: Sequence[Row]) -> str:
    """Lines for people: a line a fault and extent, all together, then every run that was unsafe or broke."""
    groups: dict[str, list[Row]] = {}
    for row in rows:
        groups.setdefault(f"{row.fault}, {row.extent}", []).append(row)
    head = f"{'fault':38} {'runs':>5} {'fired':>5} {'mid':>4} {'unsafe':>6} {'95 % below':>10} {'false':>5}"
    lines = [f"{head} {'nearest':>8}  ended"]
    lines += [_line(name, group) for name, group in sorted(groups.items())]
    lines += [_line("all", rows)] if rows else []
    for row in rows:
        if row.unsafe:
            lines.append(f"unsafe: {row.key}: {'; '.join(row.unsafe)}; {row.beyond_m * 1e3:.0f} mm beyond")
        if row.cause:
            lines.append(f"{row.cause}: {row.key}: {row.reason}")
        if row.false_m > 0.0:
            lines.append(f"falsely reached: {row.key}: {row.false_m * 1e3:.1f} mm outside")
    return "\n".join(lines)


def _line(name: str, rows: Sequence[Row]) -> str:
    """`95 % below`: the upper end of the interval of the share that is unsafe, of the runs that fired."""
    fired = [row for row in rows if row.fired]
    unsafe = sum(bool(row.unsafe) for row in fired)
    upper = wilson(unsafe, len(fired))[1]
    ends = ", ".join(f"{count} {end}" for end, count in Counter(row.outcome for row in rows).most_common())
    near = [row.nearest_m for row in rows if row.nearest_m is not None]
    nearest = f"{min(near) * 1e3:5.0f} mm" if near else "-"
    false, mid = sum(row.false_m > 0.0 for row in rows), sum(row.mid_remedy for row in rows)
    return (
        f"{name:38} {len(rows):5d} {len(fired):5d} {mid:4d} {unsafe:6d} {upper:10.2%} {false:5d} "
        f"{nearest:>8}  {ends}"
    )
