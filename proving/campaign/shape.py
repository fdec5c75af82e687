"""The shape of a campaign file."""

from __future__ import annotations

import re
from typing import Annotated, Any

from pydantic import BeforeValidator, Field, PlainSerializer, WithJsonSchema
from pydantic_core import PydanticCustomError

from executive.config.models import Name
from executive.config.validate import Strict, shown
from executive.core.units import Duration, Fraction

_BYTES = {"B": 1, "kB": 10**3, "MB": 10**6, "GB": 10**9, "KiB": 2**10, "MiB": 2**20, "GiB": 2**30}


def _read_bytes(given: object) -> int:
    found = re.fullmatch(r"(\d+(?:\.\d+)?) ?([A-Za-z]+)", given) if isinstance(given, str) else None
    if found is None or found[2] not in _BYTES:
        text = f"got {shown(given)}, expected an amount of memory such as '3 GB'"
        raise PydanticCustomError("located", "{text}", {"text": text})
    return round(float(found[1]) * _BYTES[found[2]])


Memory = Annotated[
    int,
    BeforeValidator(_read_bytes),
    PlainSerializer(lambda value: f"{value} B", return_type=str, when_used="json"),
    WithJsonSchema({"type": "string", "description": "an amount of memory", "examples": ["3 GB"]}),
    Field(gt=0),
]
Varied = dict[str, Any]
"""Keys of the scenario, joined by dots, and what stands there."""


class CaseLimits(Strict):
    """What one case may use; beyond it the case counts as failed by the system under test."""

    wall: Annotated[Duration, Field(gt=0)] = 600.0
    mission: Annotated[Duration, Field(gt=0)] | None = None
    memory: Memory = 3 * 10**9


class StopRule(Strict):
    """Stop when the Wilson interval of the share of good verdicts is narrower than `interval`."""

    confidence: Annotated[Fraction, Field(gt=0, lt=1)] = 0.95
    interval: Annotated[Fraction, Field(gt=0, lt=1)]


class FaultDraw(Strict):
    """So many faults of a list, each at most once; each entry as in a scenario's `faults`."""

    number: Any = 1
    from_: Annotated[tuple[dict[str, Any], ...], Field(alias="from", min_length=1)]


class CampaignFile(Strict):
    """One scenario, what varies, how often, and when to stop.

    Every combination of the `grid` is run `runs` times, and that with each of the settings in `compare`.
    """

    campaign: Name
    doc: str = ""
    scenario: str | dict[str, Any]
    seed: Annotated[int, Field(ge=0, lt=2**63)] = 0
    runs: Annotated[int, Field(ge=1)] = 100
    tier: Name | None = None
    vary: Varied = Field(default_factory=dict)
    grid: dict[str, Annotated[list[Any], Field(min_length=1)]] = Field(default_factory=dict)
    faults: FaultDraw | None = None
    compare: Annotated[dict[Name, Varied], Field(min_length=2)] | None = None
    limits: CaseLimits = CaseLimits()
    stop: StopRule | None = None
