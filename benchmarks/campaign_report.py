"""How long the report of 500 cases takes and how large it gets, from copies of one geometric run.

python benchmarks/campaign_report.py [CASES]
"""

import json
import os
import sys
import tempfile
from pathlib import Path

from executive.core.chance import generator
from executive.core.clock import Stopwatch
from executive.run import app
from proving.campaign_report import write_campaign_report

SETTINGS = ("plain", "other")


def main(cases: int) -> None:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "campaign"
        tell(folder, Path(name) / "run", cases)
        watch = Stopwatch()
        page = write_campaign_report(folder)
        print(f"{cases} cases: {watch.elapsed_s():.1f} s, {page.stat().st_size / 1e6:.2f} MB")


def tell(folder: Path, run: Path, cases: int) -> None:
    """Write a campaign folder whose cases share one run's record and differ in how they ended."""
    scenario = Path("scenarios/marker_out.yaml")
    result = app.run(scenario, app.RunOptions(out=run, tier="geometric", bar=False)).result.to_json()
    rng = generator(1, "told campaign")
    (folder / "cases").mkdir(parents=True)
    (folder / "campaign.json").write_text(
        json.dumps({"campaign": "told", "seed": 1, "runs": cases, "settings": SETTINGS})
    )
    for n in range(cases):
        case = folder / "cases" / f"{n:05d}"
        case.mkdir()
        for shared in ("record.mcap", "truth.mcap", "scenario.yaml"):
            os.link(run / shared, case / shared)
        about = {"index": n, "seed": n // 2, "setting": SETTINGS[n % 2], "class": None}
        about["verdict"] = "passed" if rng.random() < 0.9 else "failed"
        truth = result["truth"] | {"final_error_m": float(rng.lognormal(-5, 1))}
        (case / "result.json").write_text(json.dumps(result | {"case": about, "truth": truth}))


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 500)
