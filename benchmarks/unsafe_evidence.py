"""Is any run unsafe, whatever estimates, encoders, cameras and link say? Many seeds of every such fault.

    python -m benchmarks.unsafe_evidence --out rows.jsonl              # goes on where the file ends
    python -m benchmarks.unsafe_evidence --out rows.jsonl --count      # what it holds so far

Each fault is injected permanently, for six minutes, and for as long as ends in the midst of remedies, on the
first traverse and two missions more, on the geometric tier. Seeds are the outer loop, so that what has run so
far covers every kind. A row holds what was injected, how it ended, and every safety row that was not met.
Exit 1 if any was not. A run takes one to ten seconds.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import yaml

from executive.core.clock import Stopwatch
from executive.core.errors import ConfigError
from executive.run import app
from executive.run.fault import every_fault

CATEGORIES = ("estimation", "tracks", "cameras", "link")
FIRST_TRAVERSE = Path(__file__).parents[1] / "missions" / "first_traverse.yaml"
MARGINS = {"on_track": "30 mm", "off_track": "250 mm", "tolerance": "30 mm"}
ZIGZAG = [(2.4, -0.3), (3.0, 0.3), (3.6, -0.3), (4.2, 0.3)]
NARROW = [(2.4, -0.3), (3.5, 0.4), (4.4, 0.4)]
EXTENTS: dict[str, dict[str, Any]] = {
    "permanent": {"from": {"progress": "0.2"}},
    "transient": {"from": {"progress": "0.3"}, "for": "360 s"},
    "mid_remedy": {"from": {"progress": "0.3"}, "for": "700 s"},
}


def missions() -> dict[str, Any]:
    """The missions by name, as a scenario says them."""
    return {
        "first_traverse": str(FIRST_TRAVERSE),
        "zigzag": _mission("zigzag", ZIGZAG, {}),
        "narrow": _mission("narrow", NARROW, {"off_track": "150 mm"}),
    }


def _mission(name: str, points: list[tuple[float, float]], margins: dict[str, str]) -> dict[str, Any]:
    waypoints = [{"x": f"{x} m", "y": f"{y} m"} for x, y in points]
    return {"mission": name, "segments": MARGINS | margins, "waypoints": waypoints}


def cases(seeds: int) -> Iterator[dict[str, Any]]:
    """Every run there is, seeds in the outer loop."""
    kinds = [(name, parameters) for name in known() for parameters in _parameters(name)]
    for seed in range(seeds):
        for mission in missions():
            for extent in EXTENTS:
                for fault, parameters in kinds:
                    yield {
                        "seed": seed,
                        "mission": mission,
                        "extent": extent,
                        "fault": fault,
                        "parameters": parameters,
                    }


def known() -> list[str]:
    """The faults of these categories, by category."""
    faults = [spec for spec in every_fault() if spec.category in CATEGORIES]
    return [spec.name for spec in sorted(faults, key=lambda spec: CATEGORIES.index(spec.category))]


def _parameters(fault: str) -> list[dict[str, Any]]:
    return [{}, {"restamped": True}] if fault == "pose_stale" else [{}]


def scenario(case: dict[str, Any]) -> dict[str, Any]:
    """The case as a scenario."""
    return {
        "scenario": f"{case['fault']}_{case['extent']}",
        "mission": missions()[case["mission"]],
        "tier": "geometric",
        "seed": 1000 + case["seed"],
        "time_limit": "6 h",
        "faults": [{case["fault"]: case["parameters"], **EXTENTS[case["extent"]]}],
    }


def run(case: dict[str, Any]) -> dict[str, Any]:
    """The case with how it ended; `skipped` says why a fault cannot be injected so."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "scenario.yaml"
        file.write_text(yaml.safe_dump(scenario(case)))
        try:
            ended = app.run(file, app.RunOptions(out=Path(folder) / "run", bar=False))
        except ConfigError as error:
            return case | {"skipped": str(error).splitlines()[0]}
    result = ended.result
    return case | {
        "outcome": result.outcome,
        "reason": result.reason,
        "reached": result.waypoints.reached,
        "beyond_m": result.truth.driven_beyond_off_track_m,
        "worst_waypoint_m": max(result.truth.waypoint_errors_m, default=0.0),
        "unsafe": [row.text for row in result.safety or () if row.met is False],
        "wall_s": result.wall_s,
    }


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--out", type=Path, required=True, help="rows, one JSON object a line; appended to")
    parser.add_argument("--seeds", type=int, default=200)
    parser.add_argument("--minutes", type=float, default=float("inf"), help="begin no run after so long")
    parser.add_argument("--count", action="store_true", help="run nothing")
    chosen = parser.parse_args()
    rows = [json.loads(line) for line in chosen.out.read_text().splitlines()] if chosen.out.exists() else []
    watch = Stopwatch()
    with chosen.out.open("a") as out:
        for number, case in enumerate(cases(chosen.seeds)):
            if number < len(rows):
                continue
            if chosen.count or watch.spent_s.get("runs", 0.0) > 60 * chosen.minutes:
                break
            with watch.measure("runs"):
                rows.append(run(case))
            out.write(json.dumps(rows[-1]) + "\n")
            out.flush()
    return account(rows)


def account(rows: list[dict[str, Any]]) -> int:
    """Print what the rows say; 1 if any run was unsafe."""
    ran = [row for row in rows if "outcome" in row]
    unsafe = [row for row in ran if row["unsafe"]]
    print(f"{len(ran)} runs ({len(rows) - len(ran)} skipped), {len(unsafe)} unsafe")
    print(
        "ended " + ", ".join(f"{name} {count}" for name, count in Counter(r["outcome"] for r in ran).items())
    )
    for row in unsafe:
        print(f"unsafe: {json.dumps(row)}")
    return 1 if unsafe else 0


if __name__ == "__main__":
    sys.exit(main())
