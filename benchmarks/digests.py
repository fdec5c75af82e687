"""Does the first traverse still leave the same record, bit for bit? Seeds 0 to 4, both tiers.

    python -m benchmarks.digests              # compares with benchmarks/digests.json; exit 1 if one differs
    python -m benchmarks.digests --update     # writes what is found there, for a commit that says why

The locked versions give these digests on every x86-64 processor with AVX2 (docs/decisions/0049); elsewhere
last bits may differ. From Python 3.12 on PyBullet is another package, which the record's start names: digests
of their own. Some 3 minutes.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from pathlib import Path

from executive.record.versions import versions
from executive.run import app

KNOWN = Path(__file__).with_suffix(".json")
MISSION = Path(__file__).parents[1] / "missions" / "first_traverse.yaml"
SUFFIX = " pybullet-arm64" if "pybullet-arm64" in versions() else ""  # the record's start names the package
TIERS, SEEDS = ("geometric", "full"), range(5)


def digest(tier: str, seed: int) -> str:
    with tempfile.TemporaryDirectory() as folder:
        options = app.RunOptions(seed=seed, out=Path(folder) / "run", tier=tier, bar=False)
        return app.run(MISSION, options).result.digest


def main() -> int:
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--update", action="store_true", help="write the digests found")
    arguments.add_argument("--tier", choices=TIERS, help="this tier only")
    chosen = arguments.parse_args()
    known = json.loads(KNOWN.read_text()) if KNOWN.exists() else {}
    differing = 0
    for tier in (chosen.tier,) if chosen.tier else TIERS:
        for seed in SEEDS:
            name, found = f"{tier} {seed}{SUFFIX}", digest(tier, seed)
            same = known.get(name) == found
            differing += not same
            print(f"{name:28}  {found[:16]}  {'as before' if same else 'differs'}", flush=True)
            known[name] = found
    if chosen.update:
        KNOWN.write_text(json.dumps(known, indent=1) + "\n")
        return 0
    return 1 if differing else 0


if __name__ == "__main__":
    sys.exit(main())
