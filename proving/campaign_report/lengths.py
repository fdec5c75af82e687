"""Lengths that range from millimetres to metres, for people."""

from __future__ import annotations

from executive.report.figure import millimetres


def length(metres: float | None) -> str:
    """In mm up to a metre, in m beyond; a dash where there is none."""
    if metres is not None and abs(metres) < 5e-5:
        metres = 0.0  # never −0.0
    return f"{metres:.2f} m" if metres is not None and abs(metres) >= 1.0 else millimetres(metres)
