"""Plain data → a frozen pydantic model; every complaint located, with a guess at what was meant."""

from __future__ import annotations

import difflib
import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Annotated, Any, ParamSpec, TypeVar, get_args, get_origin

from pydantic import BaseModel, ConfigDict, ValidationError
from pydantic_core import ErrorDetails

from executive.config.source import Place, Source
from executive.core.errors import ConfigError, Problem

M = TypeVar("M", bound=BaseModel)
T = TypeVar("T")
P = ParamSpec("P")


class Strict(BaseModel):
    """Base of every model read from a file: frozen, no unknown keys, no guessing of types."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)


class Problems:
    """Collects complaints, so that one bad part does not hide the others.

    With a source it begins with the problems of that, and takes no more at values that these have spoilt.
    """

    def __init__(self, source: Source | None = None) -> None:
        self.found: list[Problem] = list(source.problems) if source else []
        self._given = frozenset(self.found)
        self._spoilt = {(mark.file, mark.line, mark.column) for mark in source.spoilt} if source else set()

    def add(self, problem: Problem) -> None:
        self.found.append(problem)

    def attempt(self, part: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T | None:
        """What the part makes of these arguments, or None after noting what was wrong with it."""
        try:
            return part(*args, **kwargs)
        except ConfigError as error:
            self.found.extend(error.problems)
            return None

    def check(self) -> None:
        """ConfigError with everything found, if anything was."""
        at = ((each, (each.file, each.line, each.column)) for each in self.found)
        found = [each for each, where in at if each in self._given or where not in self._spoilt]
        if found:
            raise ConfigError(found)


def parse(source: Source, model: type[M], at: Place = (), beside: Sequence[str] = ()) -> M:
    """The value at `at` as a `model`, or ConfigError with every complaint.

    The validation context is `{"folder": Path}`, where relative file names start from. `beside` has keys that
    others read: they are left alone.
    """
    problems = Problems(source)
    data = source.get(at)
    if not isinstance(data, dict):
        problems.add(
            source.at(at).problem(f"got {shown(data)}, expected a mapping with {_fields_text(model)}")
        )
        problems.check()
        raise ConfigError([])  # of what is spoilt all is said
    data = {key: value for key, value in data.items() if key not in beside}
    folder = {"folder": source.folder(at)}
    parsed = None
    try:
        parsed = model.model_validate_json(json.dumps(data), strict=True, context=folder)
    except ValidationError as error:
        for detail in error.errors(include_url=False, include_context=True):
            if not _counts_bad_members(detail):
                problems.add(_problem(source, at, model, detail, beside))
    problems.check()
    assert parsed is not None  # noqa: S101  (either parsed or a problem was found)
    return parsed


def _counts_bad_members(detail: ErrorDetails) -> bool:
    """Whether a list is too short only because members of it are wrong, which are problems of their own."""
    given, context = detail["input"], detail.get("ctx") or {}
    if detail["type"] != "too_short" or not isinstance(given, list):
        return False
    return len(given) >= int(context["min_length"])


def guess(word: object, known: Iterable[str]) -> str:
    """`; did you mean "x"?` for the nearest known word, or nothing."""
    near = difflib.get_close_matches(str(word), list(known), n=1, cutoff=0.6)
    return f'; did you mean "{near[0]}"?' if near else ""


def shown(data: object) -> str:
    """How a complaint shows what it got: short, and as YAML writes it."""
    if isinstance(data, Mapping):
        return "a mapping"
    if isinstance(data, list | tuple):
        return f"a list of {len(data)}"
    if data is None:
        return "nothing"
    if isinstance(data, bool):
        return str(data).lower()
    text = f'"{data}"' if isinstance(data, str) else str(data)
    return text if len(text) <= 60 else text[:56] + '..."'


def listed(words: Sequence[str]) -> str:
    """`a, b or c`, shortened when there are many."""
    if len(words) > 12:
        words = [*words[:12], "..."]
    return " or ".join([", ".join(words[:-1]), words[-1]]) if len(words) > 1 else "".join(words)


def _fields_text(model: type[BaseModel]) -> str:
    return listed(list(_keys(model)))


def _keys(model: type[BaseModel]) -> list[str]:
    return [field.alias or name for name, field in model.model_fields.items()]


def _problem(
    source: Source, at: Place, model: type[BaseModel], detail: ErrorDetails, beside: Sequence[str]
) -> Problem:
    place, rest = _known_place(source, at, tuple(detail["loc"]))
    got, context = shown(detail["input"]), detail.get("ctx") or {}
    match detail["type"]:
        case "extra_forbidden":
            inner = place[len(at) : -1]
            known = [*_keys_at(model, inner), *(beside if not inner else ())]
            message = f'got the unknown key "{place[-1]}", expected {listed(known)}{guess(place[-1], known)}'
            return source.key_at(place).problem(message)
        case "missing":
            return source.at(place).problem(f'got no "{rest[-1] if rest else place[-1]}", expected one here')
        case "literal_error" | "enum":
            known = _options(str(context.get("expected", "")))
            return source.at(place).problem(
                f"got {got}, expected {listed(known)}{guess(detail['input'], known)}"
            )
        case "quantity" | "value_error" | "located":
            return source.at(place).problem(str(context.get("text") or context.get("error") or detail["msg"]))
        case "too_short":
            least = context["min_length"]
            return source.at(place).problem(f"got {got}, expected {least} or more")
        case kind:
            expected = _EXPECTED.get(kind) or _plain(detail["msg"])
            return source.at(place).problem(f"got {got}, expected {expected}")


_EXPECTED = {
    "int_type": "a whole number",
    "int_from_float": "a whole number",
    "float_type": "a plain number",
    "bool_type": "true or false",
    "string_type": "text",
    "model_type": "a mapping",
    "dict_type": "a mapping",
    "list_type": "a list",
    "tuple_type": "a list",
}


def _plain(message: str) -> str:
    text = message.removeprefix("Input should be ").removeprefix("Value should be ")
    return text[:1].lower() + text[1:]


def _options(expected: str) -> list[str]:
    words = [word.strip(" '") for word in expected.replace(" or ", ",").split(",")]
    return [{"True": "true", "False": "false"}.get(word, word) for word in words if word]


def _known_place(source: Source, at: Place, loc: Place) -> tuple[Place, Place]:
    """Split a pydantic location into the part that stands in the file and the rest (missing keys, tags)."""
    place = at
    for index, step in enumerate(loc):
        if (*place, step) not in source.values:
            return place, loc[index:]
        place = (*place, step)
    return place, ()


def _keys_at(model: type[BaseModel], loc: Place) -> list[str]:
    """The keys that the model inside `model` at `loc` knows."""
    found: Any = model
    for step in loc:
        found = _inside(found, step)
    bare = _model_in(found)
    return _keys(bare) if bare is not None else []


def _inside(kind: Any, step: str | int) -> Any:
    model = _model_in(kind)
    if model is not None and isinstance(step, str):
        fields = {field.alias or name: field.annotation for name, field in model.model_fields.items()}
        return fields.get(step)
    for part in _parts(kind):
        if get_origin(part) in (list, tuple, dict, Sequence, Mapping):
            arguments = [a for a in get_args(part) if a is not Ellipsis]
            return arguments[min(step, len(arguments) - 1) if isinstance(step, int) else -1]
    return None


def _model_in(kind: Any) -> type[BaseModel] | None:
    for part in _parts(kind):
        if isinstance(part, type) and issubclass(part, BaseModel):
            return part
    return None


def _parts(kind: Any) -> list[Any]:
    """A type without `Annotated`, unions taken apart."""
    if get_origin(kind) is Annotated:
        return _parts(get_args(kind)[0])
    if get_origin(kind) in (list, tuple, dict, Sequence, Mapping) or not get_args(kind):
        return [kind]
    return [part for argument in get_args(kind) for part in _parts(argument)]
