"""The kind of fault that a scenario can inject, and its page in the catalogue."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

from executive.config.describe import parameters, properties
from executive.core.registry import Kind
from executive.inject.faults import FaultSpec
from executive.inject.profiles import names as profile_names
from executive.isc.hypotheses import Hypothesis


def broken_promises(spec: FaultSpec) -> Iterator[str]:
    """A sentence for each promise that a fault's declaration breaks."""
    if not spec.doc.strip():
        yield "it does not say what happens (doc)"
    if spec.hypothesis and spec.hypothesis not in {str(h) for h in Hypothesis}:
        yield f"it should lead to the unknown hypothesis {spec.hypothesis!r}"
    for role in ("node", "value", "strategy"):
        parameter = getattr(spec, role)
        if parameter is not None and parameter not in spec.model.model_fields:
            yield f"its {role} is the parameter {parameter!r}, which {spec.model.__name__} does not have"


def page(spec: FaultSpec) -> dict[str, Any]:
    """What a scenario may say of a fault, where it acts, and what it should lead to."""
    return {
        "category": spec.category,
        "doc": spec.doc,
        "parameters": [asdict(parameter) for parameter in parameters(spec.model)],
        "profiles": list(profile_names(spec.graded, spec.lasting)),
        "lasting": spec.lasting,
        "tiers": list(spec.tiers),
        "backends": list(spec.backends),
        "hypothesis": spec.hypothesis,
        "model": properties(spec.model),
    }


FAULT_KIND: Kind[FaultSpec] = Kind(
    "fault", "faults", "What can go wrong, injected.", FaultSpec, check=broken_promises, page=page
)
