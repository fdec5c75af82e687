"""JSON Schema of a scenario's `faults`, from what is installed: each kind's parameters, onsets, profiles."""

from __future__ import annotations

from typing import Any

from executive.config import distributions
from executive.config.describe import properties
from executive.core.units import DURATION, articled
from executive.run import FaultSpec, every_fault
from proving.inject.profiles import STEP, Profile
from proving.inject.triggers import Trigger

Schema = dict[str, Any]


def faults(defs: Schema) -> Schema:
    """The schema of the list; what it refers to is added to `defs`."""
    defs["trigger"] = _inlined(Trigger.model_json_schema(), defs)
    defs["profile"] = {"anyOf": [{"const": STEP}, _inlined(Profile.model_json_schema(), defs)]}
    defs["distribution"] = _distribution()
    specs = every_fault()
    defs["fault"] = {"oneOf": [_fault(spec, defs) for spec in specs]}
    defs["group"] = _group()
    return {"type": "array", "items": {"anyOf": [_ref("fault"), _ref("group")]}}


def _fault(spec: FaultSpec, defs: Schema) -> Schema:
    """One fault of this kind: its parameters beside what every fault may have."""
    given = _inlined(spec.model.model_json_schema(by_alias=True), defs)
    fields = {name: {"anyOf": [f, _ref("distribution")]} for name, f in properties(spec.model).items()}
    needed = given.get("required", [])
    parameters = _closed(fields, needed) | {"description": spec.doc}
    if not needed:
        parameters["type"] = ["object", "null"]
    own = {spec.name: parameters, "name": {"type": "string"}, "cause": {"type": "string"}} | _shared()
    if spec.lasting:
        del own["for"]
    return _closed(own, [spec.name])


def _group() -> Schema:
    own = {"group": {"type": "string"}, "faults": {"type": "array", "items": _ref("fault")}} | _shared()
    told = {"description": "faults with one cause: they come and go together"}
    return told | _closed(own, ["group", "faults"])


def _shared() -> Schema:
    duration = {"type": "string", "description": articled(DURATION.name), "examples": [DURATION.example]}
    lasting = {
        "anyOf": [duration, _ref("distribution")],
        "description": "until the end, where nothing is said",
    }
    return {"from": _ref("trigger"), "for": lasting, "profile": _ref("profile")}


def _distribution() -> Schema:
    kinds = {name: {"type": "array", "minItems": 1} for name in distributions.NAMES}
    return _closed(kinds, []) | {"minProperties": 1, "maxProperties": 1}


def _closed(fields: Schema, required: list[str]) -> Schema:
    """A mapping with these keys and no others."""
    return {"type": "object", "properties": fields, "required": required, "additionalProperties": False}


def _inlined(made: Schema, defs: Schema) -> Schema:
    """A model's schema, the models inside it moved to `defs`."""
    defs |= made.pop("$defs", {})
    return made


def _ref(name: str) -> Schema:
    return {"$ref": f"#/$defs/{name}"}
