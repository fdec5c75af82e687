"""What every fault must keep."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from executive.core.devices import DRIVE
from executive.core.errors import Breach
from executive.run.fault import Cue, Fault, FaultSpec, broken_promises
from executive.testing.bench import Bench


class FaultBreach(Breach):
    """The fault breaks promises; the message says which."""


def check_fault(spec: FaultSpec, **parameters: Any) -> None:
    """Raise FaultBreach with every promise not kept: of its declaration, and wrapped round the fake robot.

    `parameters` are those of its model, as Python values.
    """
    broken = list(broken_promises(spec))
    if not broken:
        broken += _in_use(spec, parameters)
    if broken:
        raise FaultBreach(f"fault {spec.name}", broken)


def _in_use(spec: FaultSpec, parameters: Mapping[str, Any]) -> Iterator[str]:
    try:
        fault: object = spec.make(spec.model.model_construct(**parameters))
    except Exception as error:  # whatever a plug-in raises is its defect
        yield f"it cannot be made: {type(error).__name__}: {error}"
        return
    if not isinstance(fault, Fault):
        yield f"it makes a {type(fault).__name__}, expected a Fault"
        return
    bench = Bench()
    cue = Cue(lambda: 0.0, bench.backend.clock, np.random.default_rng(0))
    if not spec.backends or "fake" in spec.backends:
        devices = fault.wrap(bench.backend.devices, cue)
        if devices[DRIVE].read() != bench.backend.devices[DRIVE].read():
            yield "while it is not active its devices read as the robot's own do"
    if not isinstance(fault.took_effect(), bool):
        yield "took_effect() says true or false"
