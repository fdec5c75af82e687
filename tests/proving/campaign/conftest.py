"""Campaigns of cases that take a third of a second, on the fake robot."""

from __future__ import annotations

import json

import pytest

INLINE = {
    "scenario": "short",
    "backend": "fake",
    "localizer": "overhead",
    "tier": "geometric",
    "time_limit": "3 h",
    "mission": {
        "mission": "short",
        "waypoints": [{"x": "2.2 m", "y": "-0.5 m"}, {"x": "2.4 m", "y": "-0.5 m"}],
    },
}
VARY = {
    "world.advance": {"uniform": [0.9, 1.0]},
    "mission.segments.off_track": {"uniform": ["20 cm", "30 cm"]},
}


@pytest.fixture
def write(tmp_path, monkeypatch):
    """Writes a campaign file into the working folder; its path."""
    monkeypatch.chdir(tmp_path)

    def make(name="small", **parts):
        content = {"campaign": name, "scenario": INLINE, "seed": 3, "runs": 4, "vary": VARY} | parts
        file = tmp_path / f"{name}.yaml"
        file.write_text(json.dumps({key: value for key, value in content.items() if value is not None}))
        return file

    return make


@pytest.fixture
def load(write):
    """A campaign, read and checked."""
    from proving.campaign.file import load_campaign

    return lambda **parts: load_campaign(write(**parts))
