"""Is any run unsafe, whatever estimates, encoders, cameras and link say? Many seeds of every such fault.

    python -m benchmarks.evidence_search --out rows.jsonl --seeds 0:6        # goes on where the file ends
    python -m benchmarks.evidence_search --out rows.jsonl --fault pose_stale --seeds 0:200
    python -m benchmarks.evidence_search --out rows.jsonl --count            # what it holds so far

Each fault of `longarm faults` that tells the executive something false is injected for good and for a while,
on the geometric tier, each seed on one of three missions (`--mission` for others than its own). Seeds are the
outer loop, so that what has run so far covers every kind. Some three seconds a run and core. Exit 1 where a
row of the safety judge was not met, or a run broke.
"""

from __future__ import annotations

import argparse
import json
import shutil
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from benchmarks.evidence_cases import EXTENTS, MISSIONS, EvidenceCase, cases, faults
from benchmarks.evidence_table import Row, table
from executive.core.clock import Stopwatch
from executive.record import History, RunResult, events
from executive.record.result import waypoint_error_m
from executive.record.truth import Track, cross_track
from executive.run.resolve import resolve_scenario
from proving.engine import Case, CaseClass, Ending, run_cases, settle


def run(wanted: Iterator[EvidenceCase], jobs: int) -> Iterator[Row]:
    """The row of each case, in the order in which they end."""
    under_way: dict[str, EvidenceCase] = {}
    with tempfile.TemporaryDirectory() as folder:

        def given() -> Iterator[Case]:
            for number, case in enumerate(wanted):
                under_way[str(number)] = case
                place = Path(folder) / str(number)
                yield Case(str(number), place / "scenario.yaml", place, text=case.scenario())

        for ending in run_cases(given(), jobs):
            yield row_of(under_way.pop(ending.case.key), ending)
            shutil.rmtree(ending.case.folder, ignore_errors=True)


def row_of(case: EvidenceCase, ending: Ending) -> Row:
    """What became of a case, read from its folder."""
    result, folder = settle(ending), ending.case.folder
    broke = ending.kind is not CaseClass.OK
    stages = result.faults[0] if result.faults else None
    return Row(
        key=case.key,
        fault=case.fault,
        extent=case.extent,
        mission=case.mission,
        seed=case.seed,
        outcome=ending.cause if broke else result.outcome or "",
        reason=(ending.detail if broke else None) or result.reason,
        fired=stages is not None and stages.fired,
        mid_remedy=stages is not None and _during_remedy(stages.t_off_s, result),
        beyond_m=result.truth.driven_beyond_off_track_m or 0.0,
        nearest_m=None if broke else nearest_m(folder),
        false_m=0.0 if broke else falsely_reached_m(folder),
        unsafe=tuple(row.text for row in result.safety or () if row.met is False),
        cause=ending.cause if broke else "",
        wall_s=round(ending.wall_s, 2),
    )


def _during_remedy(time_s: float | None, result: RunResult) -> bool:
    return time_s is not None and any(
        row.t_s <= time_s and (row.t_end_s is None or time_s <= row.t_end_s) for row in result.strategies
    )


def nearest_m(folder: Path) -> float | None:
    """How far from leaving its corridor the rover truly was when nearest to it [m]; negative beyond."""
    track = Track.of(History.of(folder / "truth.mcap"))
    if track is None:
        return None
    cross = cross_track(track, History.of(folder / "record.mcap").all(events.SegmentEvent))
    room_m = cross.off_track_m - cross.distance_m
    return float(np.nanmin(room_m)) if np.isfinite(room_m).any() else None


def falsely_reached_m(folder: Path) -> float:
    """By how much the worst way-point that was declared reached lies outside of its tolerance [m]."""
    history, track = History.of(folder / "record.mcap"), Track.of(History.of(folder / "truth.mcap"))
    route = resolve_scenario(folder / "scenario.yaml").mission.route()
    zones_m = [route[0].start_tolerance_m or route[0].tolerance_m, *(part.tolerance_m for part in route)]
    outside = [
        waypoint_error_m(track, at) - zones_m[at.event.index]
        for at in history.all(events.WaypointEvent)
        if track is not None
    ]
    return max([0.0, *outside])


def seeds_of(text: str) -> range:
    """`A:B` as Python's ranges, or `N` for the first N."""
    first, _, last = text.rpartition(":")
    return range(int(first or 0), int(last))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--out", type=Path, required=True, help="rows, one JSON object a line; appended to")
    parser.add_argument("--seeds", type=seeds_of, default=range(200), metavar="A:B")
    parser.add_argument("--fault", action="append", choices=[spec.name for spec in faults()], default=[])
    parser.add_argument("--mission", action="append", choices=list(MISSIONS), default=[])
    parser.add_argument("--extent", action="append", choices=EXTENTS, default=[])
    parser.add_argument("-j", "--jobs", type=int, default=2)
    parser.add_argument("--minutes", type=float, default=float("inf"), help="begin no run after so long")
    parser.add_argument("--count", action="store_true", help="run nothing")
    chosen = parser.parse_args()
    rows = read_rows(chosen.out)
    if not chosen.count:
        done, watch = {row.key for row in rows}, Stopwatch()
        every = cases(chosen.seeds, chosen.fault, chosen.mission, chosen.extent or EXTENTS)
        wanted = (case for case in every if case.key not in done and watch.elapsed_s() < 60 * chosen.minutes)
        with chosen.out.open("a") as out:
            if chosen.out.stat().st_size and not chosen.out.read_bytes().endswith(b"\n"):
                out.write("\n")  # behind a line that was cut off
            for row in run(wanted, chosen.jobs):
                rows.append(row)
                out.write(json.dumps(row.to_json()) + "\n")
                out.flush()
    print(table(rows))
    return 1 if any(row.unsafe or row.cause for row in rows) else 0


def read_rows(file: Path) -> list[Row]:
    """The rows written so far; a last line that was cut off is not one, and its case runs again."""
    rows = []
    for line in file.read_text().splitlines() if file.exists() else ():
        try:
            rows.append(Row.from_json(json.loads(line)))
        except json.JSONDecodeError:
            continue
    return rows


if __name__ == "__main__":
    sys.exit(main())
