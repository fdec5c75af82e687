"""Count how many seeds of each scenario are reached: `python benchmarks/acceptance.py --seeds 20`.

Each run is one line in FILE (default rows.jsonl beside this script); runs that are there already are not
repeated, so it may be interrupted. The table printed at the end is made from FILE alone.
"""

from __future__ import annotations

import argparse
import json
import shutil
import tempfile
from pathlib import Path

from executive.run import app

HERE = Path(__file__).parent
SCENARIOS = HERE.parent / "yard_robot" / "scenarios"


def main() -> None:
    """Run what is missing, then print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scenarios", nargs="*", help="names; default: all")
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--rows", type=Path, default=HERE / "rows.jsonl")
    given = parser.parse_args()
    names = given.scenarios or sorted(path.stem for path in SCENARIOS.glob("*.yaml"))
    rows = _rows(given.rows)
    with given.rows.open("a") as file:
        for seed in range(given.seeds):  # the outer loop, so that what is cut short shows every scenario
            for name in names:
                if (name, seed) not in rows:
                    rows[name, seed] = _run(name, seed)
                    print(json.dumps(rows[name, seed]), file=file, flush=True)
    _table({key: row for key, row in rows.items() if key[0] in names})


def _rows(path: Path) -> dict[tuple[str, int], dict[str, object]]:
    lines = path.read_text().splitlines() if path.is_file() else []
    rows = [json.loads(line) for line in lines]
    return {(row["scenario"], row["seed"]): row for row in rows}


def _run(name: str, seed: int) -> dict[str, object]:
    """One run, as a row."""
    folder = Path(tempfile.mkdtemp(prefix="yard-"))
    options = app.RunOptions(seed=seed, out=folder / "run", bar=False, report=False)
    app.run(SCENARIOS / f"{name}.yaml", options)
    result = json.loads((folder / "run" / "result.json").read_text())
    shutil.rmtree(folder)
    return {
        "scenario": name,
        "seed": seed,
        "outcome": result["outcome"],
        "reason": result["reason"],
        "mission_s": result["mission_s"],
        "wall_s": result["wall_s"],
        "unsafe": [row["text"] for row in result["safety"] if row["met"] is False],
        "nees": result["localisation"]["nees_mean"],
        "fixes": result["localisation"]["count"],
        "final_error_m": (result["truth"] or {}).get("final_error_m"),
        "strategies": [row["name"] for row in result["strategies"]],
        "alarms": [row["hypothesis"] for row in result["false_alarms"]],
    }


def _table(rows: dict[tuple[str, int], dict[str, object]]) -> None:
    """One line a scenario."""
    print("scenario          seeds reached unsafe false-alarms  mission  NEES  strategies")
    for name in sorted({scenario for scenario, _ in rows}):
        mine = [row for (scenario, _), row in rows.items() if scenario == name]
        reached = sum(row["outcome"] == "reached" for row in mine)
        tried: dict[str, int] = {}
        for row in mine:
            for strategy in row["strategies"]:  # type: ignore[attr-defined]  # rows are JSON: a list of names
                tried[strategy] = tried.get(strategy, 0) + 1
        nees = sum(float(row["nees"] or 0.0) for row in mine) / len(mine)  # type: ignore[arg-type]  # rows are JSON: a number or null
        print(
            f"{name:17} {len(mine):5} {reached:7} {sum(bool(row['unsafe']) for row in mine):6} "
            f"{sum(bool(row['alarms']) for row in mine):12} "
            f"{sum(float(row['mission_s']) for row in mine) / len(mine):7.0f}s {nees:5.1f}  "  # type: ignore[arg-type]  # as above
            + ", ".join(f"{strategy} {count}" for strategy, count in sorted(tried.items()))
        )
        for row in mine:
            if row["outcome"] != "reached":
                print(f"    seed {row['seed']}: {row['outcome']}, {row['reason']}")


if __name__ == "__main__":
    main()
