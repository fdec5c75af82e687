"""Hypotheses by name, for plug-ins: `Hypothesis.SLIP_TURNING` is the name "slip_turning".

Whether there is a hypothesis of that name is checked where a strategy that answers it is registered. One of
your own is declared as an `executive.isc.Hypothesis`.
"""

from __future__ import annotations


class _Names(type):
    def __getattr__(cls, name: str) -> str:
        if not name.isupper():
            raise AttributeError(f"got Hypothesis.{name}, expected a hypothesis in capitals")
        return name.lower()


class Hypothesis(metaclass=_Names):
    """The name of a hypothesis, as its attribute in capitals."""


__all__ = ["Hypothesis"]
