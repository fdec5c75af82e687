"""Protobuf schemas made from dataclasses at run time, so the dataclass is the only declaration.

A field may be float, int, bool, str, bytes, a StrEnum, another dataclass, an optional of these, a tuple of
these, a dict from str to float or str, or a float array (as its shape and its values in C order).
"""

from __future__ import annotations

import types
import typing
from collections.abc import Callable
from dataclasses import dataclass, fields, is_dataclass
from enum import StrEnum

import numpy as np
from google.protobuf.descriptor_pb2 import DescriptorProto, FieldDescriptorProto, FileDescriptorProto

_Field = FieldDescriptorProto
_SCALARS: dict[object, FieldDescriptorProto.Type.ValueType] = {
    float: _Field.TYPE_DOUBLE,
    int: _Field.TYPE_INT64,
    bool: _Field.TYPE_BOOL,
    str: _Field.TYPE_STRING,
    bytes: _Field.TYPE_BYTES,
}
PACKAGE = "longarm"


@dataclass(frozen=True)
class Shape:
    """How one field is stored: its kind, the Python type of one element, and whether it may be absent."""

    kind: typing.Literal["scalar", "enum", "message", "map", "array"]
    element: typing.Any
    repeated: bool = False
    optional: bool = False


def shape_of(hint: object) -> Shape:
    """The shape of a field annotated `hint`; TypeError for an annotation that has none."""
    origin, args = typing.get_origin(hint), typing.get_args(hint)
    if origin in (types.UnionType, typing.Union) and len(args) == 2 and args[1] is type(None):
        inner = shape_of(args[0])
        return Shape(inner.kind, inner.element, inner.repeated, optional=True)
    if origin is tuple:
        inner = shape_of(args[0])
        return Shape(inner.kind, inner.element, repeated=True)
    if origin is dict:
        return Shape("map", args[1])
    if origin is np.ndarray:
        return Shape("array", np.dtype(typing.get_args(args[1])[0]))
    if hint in _SCALARS:
        return Shape("scalar", hint)
    if isinstance(hint, type) and issubclass(hint, StrEnum):
        return Shape("enum", hint)
    if is_dataclass(hint):
        return Shape("message", hint)
    raise TypeError(f"no protobuf shape for a field of type {hint}")


def shapes(cls: type) -> dict[str, Shape]:
    """The shape of every field of a dataclass, in order."""
    hints = typing.get_type_hints(cls)
    return {f.name: shape_of(hints[f.name]) for f in fields(cls)}


def file_descriptor(cls: type) -> FileDescriptorProto:
    """A self-contained proto3 file that declares `longarm.<cls>` with all it needs nested inside."""
    file = FileDescriptorProto(name=f"longarm/{cls.__name__}.proto", package=PACKAGE, syntax="proto3")
    root = file.message_type.add(name=cls.__name__)
    _Builder(root, f".{PACKAGE}.{cls.__name__}").fill(root, cls)
    return file


class _Builder:
    """Fills one root message and the types nested in it, each nested type once."""

    def __init__(self, root: DescriptorProto, scope: str) -> None:
        self.root, self.scope = root, scope
        self.declared: set[str] = set()

    def fill(self, message: DescriptorProto, cls: type) -> None:
        for number, (name, shape) in enumerate(shapes(cls).items(), start=1):
            field = message.field.add(name=name, number=number, label=_Field.LABEL_OPTIONAL)
            if shape.repeated or shape.kind == "map":
                field.label = _Field.LABEL_REPEATED
            self._type(field, name, shape)
            if shape.optional and shape.kind != "message":
                # proto3 keeps presence of a scalar in a oneof of its own
                field.proto3_optional, field.oneof_index = True, len(message.oneof_decl)
                message.oneof_decl.add(name=f"_{name}")

    def _type(self, field: FieldDescriptorProto, name: str, shape: Shape) -> None:
        if shape.kind in ("scalar", "enum"):
            field.type = _SCALARS.get(shape.element, _Field.TYPE_STRING)
            return
        field.type = _Field.TYPE_MESSAGE
        if shape.kind == "message":
            element = shape.element
            field.type_name = self._nested(element.__name__, lambda m: self.fill(m, element))
        elif shape.kind == "map":
            # proto names a map's entry type after its field
            entry = "".join(part.capitalize() for part in name.split("_")) + "Entry"
            field.type_name = self._nested(entry, lambda m: _map_entry(m, _SCALARS[shape.element]))
        else:
            double = shape.element == np.float64
            kind = _Field.TYPE_DOUBLE if double else _Field.TYPE_FLOAT
            field.type_name = self._nested("Array" if double else "Array32", lambda m: _array(m, kind))

    def _nested(self, name: str, fill: Callable[[DescriptorProto], None]) -> str:
        if name not in self.declared:
            self.declared.add(name)
            fill(self.root.nested_type.add(name=name))
        return f"{self.scope}.{name}"


def _map_entry(entry: DescriptorProto, value: FieldDescriptorProto.Type.ValueType) -> None:
    entry.options.map_entry = True
    entry.field.add(name="key", number=1, label=_Field.LABEL_OPTIONAL, type=_Field.TYPE_STRING)
    entry.field.add(name="value", number=2, label=_Field.LABEL_OPTIONAL, type=value)


def _array(message: DescriptorProto, kind: FieldDescriptorProto.Type.ValueType) -> None:
    message.field.add(name="shape", number=1, label=_Field.LABEL_REPEATED, type=_Field.TYPE_INT64)
    message.field.add(name="data", number=2, label=_Field.LABEL_REPEATED, type=kind)
