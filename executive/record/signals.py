"""All signals there are: registered ones, what devices report, and the weights of the hypotheses.

The same table serves a run under way (each event as it is written) and a record read afterwards.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cache
from typing import Any

from executive.core import registry
from executive.core.device_spec import DEVICE_KIND, DeviceSpec, Quantity
from executive.core.values import NUMBER, ValueType
from executive.isc import hypothesis_names
from executive.record.events import DeviceReading, HypothesesEvent, Telemetry
from executive.record.signal import SIGNAL_KIND, Signal

_OF_TELEMETRY: Mapping[str, str] = {
    "left": "left_m",
    "right": "right_m",
    "left_current": "left_current_a",
    "right_current": "right_current_a",
    "moving": "moving",
    "roll": "roll_rad",
    "pitch": "pitch_rad",
    "arm": "arm_rad",
    "cabin": "cabin_rad",
    "pan": "pan_rad",
    "head_tilt": "tilt_rad",
    "tether_length": "tether_m",
    "tether_tension": "tether_n",
}
"""Where `Telemetry` has what the devices that it sums up report."""


def signals() -> Mapping[str, Signal]:
    """All there are by name."""
    return _signals(registry.ordered(DEVICE_KIND), registry.ordered(SIGNAL_KIND), tuple(hypothesis_names()))


def types() -> Mapping[str, ValueType[Any]]:
    """What an expectation may speak of."""
    return {name: signal.kind for name, signal in signals().items()}


def live_types() -> Mapping[str, ValueType[Any]]:
    """What a trigger may speak of, while the run is under way."""
    return {name: signal.kind for name, signal in signals().items() if not signal.truth}


def listener() -> Callable[[object], Iterator[tuple[str, float]]]:
    """What tells the signals that an event gives a value, of those there are now."""
    of_event: dict[type, list[Signal]] = {}
    for signal in signals().values():
        for event_type in signal.events:
            of_event.setdefault(event_type, []).append(signal)

    def heard(event: object) -> Iterator[tuple[str, float]]:
        for signal in of_event.get(type(event), ()):
            if (value := signal.read(event)) is not None:
                yield signal.name, value

    return heard


@cache
def _signals(
    devices: tuple[DeviceSpec[Any], ...], own: tuple[Signal, ...], hypotheses: tuple[str, ...]
) -> Mapping[str, Signal]:
    found = {signal.name: signal for signal in _of_devices(devices)}
    found |= {signal.name: signal for signal in own}
    return found | {name: _weight(name) for name in hypotheses}


def _of_devices(devices: Iterable[DeviceSpec[Any]]) -> Iterator[Signal]:
    """What devices report; devices that serve as another report its signals under one name."""
    of_name: dict[str, dict[str, Quantity]] = {}
    for spec in devices:
        for quantity in spec.quantities:
            of_name.setdefault(spec.signal(quantity), {})[spec.name] = quantity
    for name, quantities in of_name.items():
        first = next(iter(quantities.values()))
        events = (DeviceReading, Telemetry) if name in _OF_TELEMETRY else (DeviceReading,)
        yield Signal(name, first.type, events, _reader(name, quantities), first.doc)


def _reader(name: str, quantities: Mapping[str, Quantity]) -> Callable[[Any], float | None]:
    def read(event: Telemetry | DeviceReading) -> float | None:
        if isinstance(event, Telemetry):
            value: float = getattr(event, _OF_TELEMETRY[name])
            return value
        quantity = quantities.get(event.device)
        return None if quantity is None else event.values.get(quantity.name)

    return read


def _weight(hypothesis: str) -> Signal:
    return Signal(
        hypothesis, NUMBER, (HypothesesEvent,), lambda event: event.weights.get(hypothesis), "weight of it"
    )
