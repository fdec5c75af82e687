"""Writes every command to a device into the record, on its way there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from executive.core.device_spec import Fitted, Verb
from executive.core.ports import Devices
from executive.record.events import Command

Write = Callable[[Command], None]


def logged(devices: Devices, write: Write) -> Devices:
    """The same devices, their commands written before they are carried out. Readings are not commands."""
    return Devices(*(_logged(one, write) if one.spec.verbs else one for one in devices))


def _logged(one: Fitted, write: Write) -> Fitted:
    log = _Log(one.spec.name, write)
    verbs = {verb.name: log.of(verb, one.device) for verb in one.spec.verbs}
    return Fitted(one.spec, _LoggedDevice(one.device, verbs))


class _LoggedDevice:
    """Whatever the device is, with its verbs written down."""

    def __init__(self, device: object, verbs: dict[str, Callable[..., Any]]) -> None:
        self._device = device
        self.__dict__.update(verbs)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._device, name)


@dataclass
class _Log:
    """The commands of one device. A stop is for what was sent since the last one."""

    device: str
    write: Write
    _told: bool = False

    def of(self, verb: Verb, device: Any) -> Callable[..., Any]:
        """The method that this verb is, written down."""

        def send(*given: Any, **by_name: Any) -> Any:
            self.write(Command(self.device, verb.name, dict(verb.values(*given, **by_name))))
            self._told = True
            return getattr(device, verb.name)(*given, **by_name)

        def stopped(*given: Any, **by_name: Any) -> Any:
            # first of all, whatever becomes of the record
            answer = getattr(device, verb.name)(*given, **by_name)
            if self._told:
                self._told = False
                self.write(Command(self.device, verb.name, dict(verb.values(*given, **by_name))))
            return answer

        return stopped if verb.stops else send
