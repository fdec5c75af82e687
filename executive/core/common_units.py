"""The units that nearly every file uses, as pint has them: its own table takes half a second to make."""

from __future__ import annotations

from decimal import Decimal

Dimension = tuple[tuple[str, int], ...]
"""Exponents of root units, sorted by name: a speed is (("meter", 1), ("second", -1)). Angle counts as one."""

_BY_DIMENSION: dict[Dimension, dict[str, str]] = {
    (("meter", 1),): {"m": "1", "mm": "0.001", "cm": "0.01", "km": "1000", "um": "0.000001"},
    (("radian", 1),): {"rad": "1", "mrad": "0.001", "deg": "0.017453292519943295"},
    (("second", 1),): {"s": "1", "ms": "0.001", "min": "60", "h": "3600"},
    (("meter", 1), ("second", -1)): {"m/s": "1", "mm/s": "0.001", "cm/s": "0.01"},
    (("radian", 1), ("second", -1)): {"rad/s": "1", "deg/s": "0.017453292519943295"},
    (("meter", 1), ("second", -2)): {"m/s^2": "1", "mm/s^2": "0.001"},
    (("kilogram", 1),): {"kg": "1", "g": "0.001"},
    (("kilogram", 1), ("meter", 1), ("second", -2)): {"N": "1", "mN": "0.001", "kN": "1000"},
    (("kilogram", 1), ("meter", -1), ("second", -2)): {"Pa": "1", "kPa": "1000", "MPa": "1000000"},
    (("kilogram", 1), ("meter", 2), ("second", -3)): {"W": "1", "mW": "0.001", "uW": "0.000001"},
    (("ampere", 1),): {"A": "1", "mA": "0.001", "uA": "0.000001"},
}

COMMON: dict[str, tuple[Decimal, Dimension]] = {
    unit: (Decimal(scale), dimension)
    for dimension, scales in _BY_DIMENSION.items()
    for unit, scale in scales.items()
}
"""What one of each unit is in SI, and its dimension."""
