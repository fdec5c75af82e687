"""Values to protobuf bytes and back, exactly: `decode(encode(x))` equals x, bit for bit in every float."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any, Generic, TypeVar

import numpy as np
from google.protobuf.descriptor_pool import DescriptorPool
from google.protobuf.message import Message
from google.protobuf.message_factory import GetMessageClass

from executive.record.schema import (
    PACKAGE,
    Shape,
    file_descriptor,
    shapes,
)

T = TypeVar("T")
_Put = Callable[[Any, Any], None]
_Get = Callable[[Any], Any]


class Codec(Generic[T]):
    """Writes and reads one dataclass through a schema made from it, in a pool of its own."""

    def __init__(self, cls: type[T]) -> None:
        self.cls = cls
        pool = DescriptorPool()
        pool.Add(file_descriptor(cls))
        self.message: type[Message] = GetMessageClass(pool.FindMessageTypeByName(f"{PACKAGE}.{cls.__name__}"))
        key: Any = cls  # mypy does not take a type variable for hashable
        self._puts, self._gets = _puts(key), _gets(key)

    def encode(self, value: T) -> bytes:
        """The bytes of `value`; equal values give equal bytes."""
        message = self.message()
        for put in self._puts:
            put(message, value)
        return message.SerializeToString(deterministic=True)

    def decode(self, payload: bytes) -> T:
        """The value; google.protobuf.message.DecodeError if the bytes are no such message."""
        message = self.message.FromString(payload)
        return self.cls(**{name: get(message) for name, get in self._gets.items()})


@functools.cache
def _puts(cls: type) -> list[_Put]:
    return [_put(name, shape) for name, shape in shapes(cls).items()]


@functools.cache
def _gets(cls: type) -> dict[str, _Get]:
    return {name: _get(name, shape) for name, shape in shapes(cls).items()}


def _put(name: str, shape: Shape) -> _Put:
    """A function that copies field `name` of a value into a message."""
    if shape.optional:
        inner = _put(name, Shape(shape.kind, shape.element, shape.repeated))
        return lambda message, value: inner(message, value) if getattr(value, name) is not None else None
    if shape.kind == "map":
        return lambda message, value: getattr(message, name).update(getattr(value, name))
    if shape.kind == "array":
        return lambda message, value: _put_array(getattr(message, name), getattr(value, name))
    if shape.kind == "message" and shape.repeated:
        return lambda message, value: _put_all(getattr(message, name), getattr(value, name), shape.element)
    if shape.kind == "message":
        return lambda message, value: _put_one(getattr(message, name), getattr(value, name), shape.element)
    if shape.repeated:
        return lambda message, value: getattr(message, name).extend(getattr(value, name))
    return lambda message, value: setattr(message, name, getattr(value, name))


def _put_one(message: Any, value: object, cls: type) -> None:
    message.SetInParent()  # present even if every field has its default
    for put in _puts(cls):
        put(message, value)


def _put_all(messages: Any, values: Any, cls: type) -> None:
    for value in values:
        _put_one(messages.add(), value, cls)


def _put_array(message: Any, array: Any) -> None:
    message.SetInParent()
    message.shape.extend(array.shape)
    message.data.extend(array.ravel().tolist())


def _get(name: str, shape: Shape) -> _Get:
    """A function that reads field `name` out of a message."""
    if shape.optional:
        inner = _get(name, Shape(shape.kind, shape.element, shape.repeated))
        return lambda message: inner(message) if message.HasField(name) else None
    if shape.kind == "map":
        return lambda message: dict(sorted(getattr(message, name).items()))
    if shape.kind == "array":
        return lambda message: _get_array(getattr(message, name), shape.element)
    if shape.repeated:
        return lambda message: tuple(_get_element(x, shape) for x in getattr(message, name))
    return lambda message: _get_element(getattr(message, name), shape)


def _get_element(value: Any, shape: Shape) -> Any:
    if shape.kind == "message":
        return shape.element(**{name: get(value) for name, get in _gets(shape.element).items()})
    return shape.element(value) if shape.kind == "enum" else value


def _get_array(message: Any, dtype: np.dtype[Any]) -> Any:
    return np.array(message.data, dtype=dtype).reshape(tuple(message.shape))
