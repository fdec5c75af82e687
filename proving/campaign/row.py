"""One case as a row of a table: `read_parquet('DIR/cases/*/result.parquet')`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from executive.core import units
from executive.core.units import UnitError
from proving.campaign.result import CaseResult

_TRUTH = (
    *("final_error_m", "max_cross_track_m", "driven_beyond_off_track_m"),
    *("max_tilt_deg", "path_m", "tether_max_n"),
)
_FIXES = ("position_rmse_m", "yaw_rmse_deg", "nees_mean")
_EXPECTATION = pa.struct(
    [
        ("text", pa.string()),
        ("met", pa.bool_()),
        ("robustness", pa.float64()),
        ("t_violation_s", pa.float64()),
    ]
)
_STRATEGY = pa.struct(
    [
        *(("name", pa.string()), ("t_s", pa.float64()), ("hypothesis", pa.string())),
        *(("weight", pa.float64()), ("helped", pa.bool_())),
    ]
)
_FAULT = pa.struct(
    [
        *(("name", pa.string()), ("kind", pa.string()), ("cause", pa.string()), ("fired", pa.bool_())),
        *((f"t_{stage}_s", pa.float64()) for stage in ("armed", "on", "observable", "detected", "isolated")),
        *(("hypothesis", pa.string()), ("expected", pa.string())),
        *((f"t_{stage}_s", pa.float64()) for stage in ("recovered", "off")),
    ]
)
SCHEMA = pa.schema(
    [
        *(("campaign", pa.string()), ("scenario", pa.string())),
        *(("case", pa.int64()), ("draw", pa.int64()), ("setting", pa.string()), ("seed", pa.int64())),
        *(
            (name, pa.string())
            for name in ("tier", "verdict", "message", "class", "cause", "outcome", "ended_as", "reason")
        ),
        *(("mission_s", pa.float64()), ("digest", pa.string()), ("attempts", pa.int64())),
        *(("waypoints_total", pa.int64()), ("waypoints_reached", pa.int64())),
        *((name, pa.float64()) for name in _TRUTH),
        ("waypoint_errors_m", pa.list_(pa.float64())),
        *(("fixes", pa.int64()), ("fixes_failed", pa.int64())),
        *((name, pa.float64()) for name in _FIXES),
        ("strategies", pa.list_(_STRATEGY)),
        ("faults", pa.list_(_FAULT)),
        ("false_alarms", pa.int64()),
        ("expectations", pa.list_(_EXPECTATION)),
        ("safety", pa.list_(_EXPECTATION)),
        ("safe", pa.bool_()),
        ("drawn", pa.map_(pa.string(), pa.string())),
        ("drawn_si", pa.map_(pa.string(), pa.float64())),
        *(("wall_s", pa.float64()), ("wall", pa.map_(pa.string(), pa.float64()))),
        ("memory_bytes", pa.int64()),
    ]
)
"""Every row of every campaign has these columns, whatever became of the case."""


def row_of(campaign: str, result: CaseResult) -> dict[str, object]:
    """The row of a case, by the columns of SCHEMA; ValueError if no campaign has judged it."""
    run, case = result.run, result.case
    if case is None:
        raise ValueError("got a run that is no case of a campaign")
    truth, fixes, safety = asdict(run.truth), run.localisation, [asdict(row) for row in run.safety or ()]
    return {
        "campaign": campaign,
        "case": case.index,
        "class": case.class_,
        **{name: getattr(case, name) for name in ("draw", "setting", "verdict", "message", "cause")},
        **{name: getattr(case, name) for name in ("attempts", "wall_s", "memory_bytes")},
        **{name: getattr(run, name) for name in ("scenario", "seed", "tier", "outcome", "reason")},
        "ended_as": run.ended_as,
        **{name: getattr(run, name) for name in ("mission_s", "digest", "wall")},
        **{name: truth[name] for name in (*_TRUTH, "waypoint_errors_m")},
        **{name: getattr(fixes, name) for name in _FIXES},
        "fixes": fixes.count,
        "fixes_failed": fixes.failed,
        "waypoints_total": run.waypoints.total,
        "waypoints_reached": run.waypoints.reached,
        "strategies": [asdict(row) for row in run.strategies],
        "faults": [asdict(row) for row in run.faults],
        "false_alarms": len(run.false_alarms),
        "expectations": [asdict(row) for row in run.expectations],
        "safety": safety,
        "safe": all(row["met"] is not False for row in safety) if safety else None,
        "drawn": dict(case.drawn),
        "drawn_si": {key: value for key, text in case.drawn.items() if (value := _si(text)) is not None},
    }


def write_row(path: Path, row: Mapping[str, object]) -> None:
    """A file of one row. Keys of nested rows that the schema does not know are left out."""
    pq.write_table(pa.Table.from_pylist([dict(row)], schema=SCHEMA), path, compression="zstd")


def _si(text: str) -> float | None:
    """The number that a drawn text stands for, in SI; None if it is no number."""
    try:
        return units.parse(text)[0]
    except UnitError:
        return None
