"""What a seed draws of a fault's parameters: what must be said, and how much where it is more or less.

Every other seed takes the default severity of the catalogue, the rest draw it: what is only just too small
to be noticed is no less dangerous than what is large.
"""

from __future__ import annotations

import math

import numpy as np

from executive.run.fault import FaultSpec

SIDES = {"tracks": "side", "cameras": "camera"}

Ranges = dict[str, tuple[float, float, str]]
"""Lowest, highest and unit by parameter; drawn evenly in the logarithm, or evenly where one is negative."""

SEVERITY: dict[str, Ranges] = {
    "inclinometer_bias": {"roll": (-8.0, 8.0, " deg"), "pitch": (-8.0, 8.0, " deg")},
    "encoder_lost_counts": {"share": (0.02, 0.6, "")},
    "encoder_scale": {"factor": (0.6, 1.6, "")},
    "track_weak": {"factor": (0.3, 0.95, "")},
    "motor_runaway": {"lasts": (5.0, 60.0, " s"), "factor": (1.0, 2.0, "")},
    "currents_garbage": {"up_to": (0.5, 5.0, " A")},
    "calibration_drift": {"u": (-8.0, 8.0, ""), "v": (-4.0, 4.0, "")},
    "exposure_off": {"factor": (0.05, 5.0, "")},
    "head_vibration": {"amplitude": (0.005, 0.1, " deg")},
    "image_blur": {"sigma": (0.5, 4.0, "")},
    "head_backlash": {"play": (0.05, 1.0, " deg")},
    "head_encoder_offset": {"pan": (-2.0, 2.0, " deg"), "tilt": (-0.5, 0.5, " deg")},
    "head_offset": {"pan": (-2.0, 2.0, " deg"), "tilt": (-0.5, 0.5, " deg")},
    "head_step_loss": {"share": (0.01, 0.3, "")},
    "lander_settling": {
        "sinks": (0.002, 0.05, " m"),
        "leans": (0.05, 1.0, " deg"),
        "twists": (-1.0, 1.0, " deg"),
    },
}
SHIFT_M = (0.02, 0.6)
"""How far a false pose lies from the true one, in any direction."""


def drawn(spec: FaultSpec, seed: int, chance: np.random.Generator) -> dict[str, object]:
    """The parameters of a fault for this seed."""
    parameters: dict[str, object] = {}
    for name, field in spec.model.model_fields.items():
        if field.is_required() and name == SIDES.get(spec.category):
            parameters[name] = str(chance.choice(["left", "right"]))
    if seed % 2:
        parameters |= {name: _amount(chance, *of) for name, of in SEVERITY.get(spec.name, {}).items()}
        if spec.name == "pose_outlier":
            parameters |= _shift(chance)
    if spec.name == "pose_stale":
        parameters["restamped"] = bool(chance.integers(2))
    return parameters


def _amount(chance: np.random.Generator, low: float, high: float, unit: str) -> str | float:
    drawn = chance.uniform(low, high) if low < 0 else math.exp(chance.uniform(math.log(low), math.log(high)))
    value = float(f"{drawn:.3g}")
    return f"{value}{unit}" if unit else value


def _shift(chance: np.random.Generator) -> dict[str, object]:
    length = math.exp(chance.uniform(*map(math.log, SHIFT_M)))
    angle = chance.uniform(-math.pi, math.pi)
    return {"x": f"{length * math.cos(angle):.4f} m", "y": f"{length * math.sin(angle):.4f} m"}
