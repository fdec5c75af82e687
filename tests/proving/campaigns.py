"""A campaign folder told rather than run: variants of one synthetic run, with planted faults and ends."""

from __future__ import annotations

import copy
import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

SETTINGS = ("plain", "other")
ON_S = 600.0


def fault(kind: str, concluded: str | None, expected: str, after_s: float = 40.0) -> dict[str, Any]:
    """A row of `result.json` for a fault that fired at ON_S and was noticed `after_s` later, or never."""
    noticed = concluded is not None
    return {
        "name": kind,
        "kind": kind,
        "cause": None,
        "fired": True,
        "t_armed_s": ON_S - 1,
        "t_on_s": ON_S,
        "t_observable_s": ON_S,
        "t_detected_s": ON_S + after_s if noticed else None,
        "t_isolated_s": ON_S + 2 * after_s if concluded == expected else None,
        "hypothesis": concluded,
        "expected": expected,
        "t_recovered_s": ON_S + 5 * after_s if noticed else None,
        "t_off_s": None,
    }


class Told:
    """Writes the folder case by case; `base` is a run folder whose record and truth every case shares."""

    def __init__(self, folder: Path, base: Path, settings: tuple[str, ...] = ()) -> None:
        self.folder, self.base = folder, base
        self.result = json.loads((base / "result.json").read_text())
        (folder / "cases").mkdir(parents=True)
        about = {"campaign": "told", "doc": "A test.", "seed": 5, "total": 40, "scenario": "synthetic"}
        about |= {"settings": list(settings), "command": "longarm campaign told.yaml"}
        (folder / "campaign.json").write_text(json.dumps(about))
        (folder / "journal.jsonl").write_text("")

    def case(
        self,
        index: int,
        faults: tuple[Mapping[str, Any], ...] = (),
        *,
        outcome: str = "reached",
        error_m: float = 0.005,
        setting: str = "",
        seed: int | None = None,
        sun_deg: float = 35.0,
        **more: Any,
    ) -> Path:
        """Add a case; `more` replaces keys of its result."""
        result = copy.deepcopy(self.result) | {"outcome": outcome, "reason": None, "faults": list(faults)}
        seed = index if seed is None else seed
        result |= {"expectations": [], "strategies": [], "seed": seed, "safety": [], "false_alarms": []}
        result["truth"] |= {"final_error_m": error_m, "driven_beyond_off_track_m": 0.0}
        result["case"] = {"index": index, "seed": seed, "setting": setting, "class": None}
        result["case"]["verdict"] = "passed" if outcome == "reached" else "failed"
        folder = self.folder / "cases" / f"{index:05d}"
        folder.mkdir()
        (folder / "result.json").write_text(json.dumps(result | more))
        scenario = {
            "rig": {"rover": {"tilt_limit": "0.5 rad"}},
            "mission": {"segments": {"off_track": "250 mm"}},
            "world": {"light": {"sun_elevation": f"{sun_deg} deg"}},
            "faults": [{row["kind"]: {}, "name": row["name"]} for row in faults],
        }
        (folder / "scenario.yaml").write_text(yaml.safe_dump(scenario))
        for name in ("record.mcap", "truth.mcap"):
            os.link(self.base / name, folder / name)
        return folder

    def note(self, **entry: Any) -> None:
        """Add a line to the journal."""
        with (self.folder / "journal.jsonl").open("a") as file:
            file.write(json.dumps(entry) + "\n")
