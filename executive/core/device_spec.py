"""What a device declares of itself: what it reports, what it can be told, how it comes to rest."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from executive.core.registry import Kind
from executive.core.values import ValueType

T = TypeVar("T")


@dataclass(frozen=True)
class Quantity:
    """One number that a device reports: its type (and so its unit), and how to take it out of a reading.

    `signal` is the name under which triggers and expectations speak of it; by default DEVICE_NAME.
    """

    name: str
    type: ValueType[Any]
    doc: str
    of: Callable[[Any], float | bool]
    signal: str = ""


def nothing(*given: object, **by_name: object) -> Mapping[str, float]:
    """The values of a command whose arguments the record does not keep."""
    return {}


def numbers(*names: str) -> Callable[..., Mapping[str, float]]:
    """The values of a command whose arguments are these numbers, in this order."""

    def values(*given: float, **by_name: float) -> Mapping[str, float]:
        return dict(zip(names, given, strict=False)) | by_name

    return values


@dataclass(frozen=True)
class Verb:
    """A method of a port that tells the device something; `values` are what the record keeps of it.

    A `stops` verb is carried out before it is recorded, and recorded once: one that repeats it says nothing.
    """

    name: str
    values: Callable[..., Mapping[str, float]] = nothing
    stops: bool = False


def _read(device: Any) -> object:
    return device.read()


@dataclass(frozen=True, eq=False)
class DeviceSpec(Generic[T]):
    """A device by name, and the type that all who use it rely on (`port`, most often a Protocol).

    `quantities` are taken out of what `read` returns, once per sample of telemetry; a device without any is
    not read. What is `sensed` is read every tick, as evidence for the classification. `verbs`
    are what the record keeps of what it is told. `rest` brings it to rest, where it can be
    anything else. `serves` is the device that this one is a kind of: tracks serve as a drive.
    """

    name: str
    doc: str
    port: type[Any]
    quantities: tuple[Quantity, ...] = ()
    verbs: tuple[Verb, ...] = ()
    read: Callable[[T], object] = _read
    rest: Callable[[T], None] | None = None
    serves: DeviceSpec[T] | None = None
    sensed: bool = True

    def fit(self, device: T) -> Fitted:
        """This device, by an object that answers for it."""
        return Fitted(self, device)

    def sample(self, device: T) -> dict[str, float]:
        """What it reports now, by quantity."""
        reading = self.read(device) if self.quantities else None
        return {quantity.name: float(quantity.of(reading)) for quantity in self.quantities}

    def signal(self, quantity: Quantity) -> str:
        """The name of the signal that this quantity is."""
        return quantity.signal or f"{self.name}_{quantity.name}"

    @property
    def names(self) -> tuple[str, ...]:
        """The names it answers to: its own, and that of the device it serves as."""
        return (self.name,) if self.serves is None else (self.name, *self.serves.names)


def _broken(spec: DeviceSpec[Any]) -> Iterator[str]:
    if not spec.doc.strip():
        yield "it does not say what it is"
    names = [quantity.name for quantity in spec.quantities]
    yield from (f"it reports {name} twice" for name in sorted(set(names)) if names.count(name) > 1)
    for quantity in spec.quantities:
        if quantity.type.python not in (float, int, bool):
            yield f"{quantity.name} is a {quantity.type.name}, which is no number"
    yield from (f"its port has no {verb.name}" for verb in spec.verbs if not hasattr(spec.port, verb.name))


def _page(spec: DeviceSpec[Any]) -> Mapping[str, Any]:
    """What the catalogue says of a device: what it reports and can be told, and what it serves as."""
    return {
        "doc": spec.doc,
        "port": f"{spec.port.__module__}.{spec.port.__qualname__}",
        "reports": [
            {"signal": spec.signal(q), "type": q.type.name, "unit": q.type.unit, "doc": q.doc}
            for q in spec.quantities
        ],
        "commands": [verb.name for verb in spec.verbs],
        "serves": None if spec.serves is None else spec.serves.name,
    }


DEVICE_KIND: Kind[DeviceSpec[Any]] = Kind(
    "device",
    "devices",
    "What a robot has: what it reports, what it can be told.",
    DeviceSpec,
    check=_broken,
    page=_page,
)


@dataclass(frozen=True)
class Fitted:
    """A device of a robot: what it declares, and the object that answers for it."""

    spec: DeviceSpec[Any]
    device: Any
