"""Agreement with rtamt's discrete-time offline monitor, at every sample and to the last digit but a few."""

import numpy as np
import pytest

from executive.core.chance import generator
from proving.judge.temporal import on_one_grid, parse_formula
from proving.judge.temporal.semantics import Margins, evaluate
from tests.proving.judge.temporal.random_formulas import TYPES, formula

rtamt = pytest.importorskip("rtamt", reason="rtamt, which is only needed to be compared with, is not there")

BATCHES, EACH, DEPTH = 10, 100, 3


def theirs(text: str, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """The robustness at every sample, as rtamt has it; samples are a second apart."""
    specification = rtamt.StlDiscreteTimeSpecification()
    for name in ("x", "y", "out"):
        specification.declare_var(name, "float")
    specification.spec = f"out = {text}"
    specification.parse()
    data = {"time": list(range(len(x))), "x": x.tolist(), "y": y.tolist()}
    return np.array([value for _, value in specification.evaluate(data)])


def ours(text: str, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    times_s = np.arange(len(x), dtype=float)
    trace = on_one_grid({"x": (times_s, x), "y": (times_s, y)}, times_s[-1])
    return evaluate(parse_formula(text, TYPES), trace, Margins(trace))


@pytest.mark.parametrize("batch", range(BATCHES))
def test_robustness_agrees_on_random_formulas_and_traces(batch):
    rng = generator(batch, "formulas")
    for _ in range(EACH):
        written = formula(rng, DEPTH)
        x, y = rng.normal(size=(2, int(rng.integers(2, 40))))  # rtamt fails on a single sample
        np.testing.assert_allclose(
            ours(written.ours, x, y), theirs(written.theirs, x, y), rtol=0, atol=1e-9, err_msg=written.ours
        )
