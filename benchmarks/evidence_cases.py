"""The runs of the search for unsafe evidence: every such fault, for good and for a while, by seed.

A seed draws when the fault begins, how severe it is, and how long it lasts where it ends. The durations are
those of one look to several remedies, so that many end while a remedy is under way.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import yaml

from benchmarks.evidence_parameters import drawn
from executive.core.chance import generator
from executive.run.fault import FaultSpec, every_fault

CATEGORIES = ("estimation", "tracks", "cameras", "head", "link")
"""Encoders are those of the tracks and of the head."""

COMPANIONS: dict[str, dict[str, object]] = {
    "arm_locked": {"led_off": {"markers": [0, 1, 2, 3]}},
    "cabin_locked": {"led_off": {"markers": [0, 1, 2, 3]}},
    "link": {"pose_nan": {}},
}
"""What begins with a fault, by its name or category, that shows only once something else is wrong."""

FIRST_TRAVERSE = Path(__file__).parents[1] / "missions" / "first_traverse.yaml"
TIER = "geometric"
LONG = [(2.4, -0.3), (4.9, 0.2), (7.3, -0.4)]
SHARP = [(2.4, -0.3), (3.3, 0.3), (3.1, -0.5), (4.0, -0.1)]
EXTENTS = ("permanent", "transient")
PROGRESS, LASTS_S = (0.02, 0.9), (60.0, 1800.0)


def _mission(name: str, points: Sequence[tuple[float, float]], off_track: str) -> dict[str, object]:
    margins = {"on_track": "30 mm", "off_track": off_track, "tolerance": "30 mm"}
    waypoints = [{"x": f"{x} m", "y": f"{y} m"} for x, y in points]
    return {"mission": name, "segments": margins, "waypoints": waypoints}


MISSIONS: dict[str, object] = {
    "first_traverse": str(FIRST_TRAVERSE),
    "long_segments": _mission("long_segments", LONG, "200 mm"),
    "sharp_turns": _mission("sharp_turns", SHARP, "120 mm"),
}


@dataclass(frozen=True)
class EvidenceCase:
    """One run: all that is drawn follows from these four."""

    fault: str
    extent: str
    mission: str
    seed: int

    @property
    def key(self) -> str:
        """What tells it apart, and the same in every process."""
        return f"{self.fault}/{self.extent}/{self.mission}/{self.seed}"

    def scenario(self) -> str:
        """The scenario file."""
        spec = next(spec for spec in faults() if spec.name == self.fault)
        chance = generator(self.seed, f"evidence {self.key}")
        onset = f"{chance.uniform(*PROGRESS):.3f}"
        entry: dict[str, object] = {self.fault: drawn(spec, self.seed, chance), "from": {"progress": onset}}
        if self.extent == "transient":
            lasts_s = math.exp(chance.uniform(*map(math.log, LASTS_S)))
            entry["for"] = f"{lasts_s:.0f} s"
        companion = COMPANIONS.get(spec.name) or COMPANIONS.get(spec.category)
        scenario = {
            "scenario": f"{self.fault}_{self.extent}_{self.mission}",
            "mission": MISSIONS[self.mission],
            "tier": TIER,
            "seed": 1000 + self.seed,
            "time_limit": "6 h",
            "faults": [entry, *([companion | {"from": {"progress": onset}}] if companion else [])],
        }
        return str(yaml.safe_dump(scenario, sort_keys=False))


@cache
def faults() -> tuple[FaultSpec, ...]:
    """The faults of these categories that can act in the geometric tier, by category."""
    found = [spec for spec in every_fault() if spec.category in CATEGORIES and _acts(spec)]
    return tuple(sorted(found, key=lambda spec: (CATEGORIES.index(spec.category), spec.name)))


def _acts(spec: FaultSpec) -> bool:
    return not spec.tiers or TIER in spec.tiers


def cases(
    seeds: range, names: Sequence[str] = (), missions: Sequence[str] = (), extents: Sequence[str] = EXTENTS
) -> Iterator[EvidenceCase]:
    """Every run there is, seeds in the outer loop. Without `missions`, each seed has one, in turn."""
    chosen = [spec for spec in faults() if not names or spec.name in names]
    for seed in seeds:
        for mission in missions or (tuple(MISSIONS)[seed % len(MISSIONS)],):
            for spec in chosen:
                for extent in extents:
                    if extent == "transient" and spec.lasting:
                        continue  # it cannot be taken back
                    yield EvidenceCase(spec.name, extent, mission, seed)
