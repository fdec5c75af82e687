"""Timed until, and what else a formula is made of, beside rtamt: seconds for one formula over one trace.

    python benchmarks/temporal.py                      # ours alone where rtamt is not installed
    python benchmarks/temporal.py --samples 1000 10000 --windows 10 100

rtamt's timed until takes time in proportion to samples times window; `--patience` seconds is what it is
allowed by a guess from the case before, beyond that the case is left out.
"""

from __future__ import annotations

import argparse
import importlib.util
from collections.abc import Callable

import numpy as np

from executive.core.chance import generator
from executive.core.clock import Stopwatch
from executive.core.types import Array
from executive.core.values import NUMBER
from proving.judge.temporal import judge, on_one_grid, parse_formula

FORMULAS = (
    "x > -2 until[0{u}{sep}{window}{u}] y > 2",
    "always[0{u}{sep}{window}{u}] x > -9",
    "always ((x > 2) implies (eventually[0{u}{sep}{window}{u}] (y > 2)))",
)


def signals(samples: int) -> tuple[Array, Array]:
    x, y = generator(7, "signals").normal(size=(2, samples))
    return x, y


def ours_s(template: str, window: int, x: Array, y: Array) -> float:
    """From text and samples to verdict, robustness, time of violation and warnings."""
    times_s = np.arange(len(x), dtype=np.float64)
    watch = Stopwatch()
    formula = parse_formula(template.format(u=" s", sep=", ", window=window), {"x": NUMBER, "y": NUMBER})
    judge(formula, on_one_grid({"x": (times_s, x), "y": (times_s, y)}, times_s[-1]))
    return watch.elapsed_s()


def rtamts_s(template: str, window: int, x: Array, y: Array) -> float:
    """From text and samples to robustness alone."""
    import rtamt

    data = {"time": list(range(len(x))), "x": x.tolist(), "y": y.tolist()}
    watch = Stopwatch()
    specification = rtamt.StlDiscreteTimeSpecification()
    for name in ("x", "y", "out"):
        specification.declare_var(name, "float")
    specification.spec = "out = " + template.format(u="", sep=":", window=window)
    specification.parse()
    specification.evaluate(data)
    return watch.elapsed_s()


def no_time(*case: object) -> None:
    """What a library that is not there takes."""


def within_patience(
    run: Callable[[str, int, Array, Array], float], patience_s: float
) -> Callable[[str, int, Array, Array], float | None]:
    """Leaves out what would take too long if cost were as samples times window squared."""
    rates: dict[str, float] = {}

    def timed(template: str, window: int, x: Array, y: Array) -> float | None:
        work = len(x) * window**2
        if rates.get(template, 0.0) * work > patience_s and "until" in template:
            return None
        spent_s = run(template, window, x, y)
        rates[template] = spent_s / work
        return spent_s

    return timed


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--samples", type=int, nargs="+", default=[1_000, 10_000, 50_000])
    parser.add_argument("--windows", type=int, nargs="+", default=[100, 5_000])
    parser.add_argument("--patience", type=float, default=120.0, help="seconds to wait for one case of rtamt")
    chosen = parser.parse_args()
    rtamt_there = importlib.util.find_spec("rtamt") is not None
    theirs = within_patience(rtamts_s, chosen.patience) if rtamt_there else no_time
    ours_s(FORMULAS[0], 1, *signals(1))  # the first to speak of seconds waits for the table of units
    print(f"{'formula':66} {'samples':>8} {'window':>7} {'ours [s]':>9} {'rtamt [s]':>10}")
    for template in FORMULAS:
        for window in chosen.windows:
            for samples in chosen.samples:
                x, y = signals(samples)
                mine, other = ours_s(template, window, x, y), theirs(template, window, x, y)
                text = template.format(u=" s", sep=", ", window=window)
                shown = "-" if other is None else f"{other:.2f}"
                print(f"{text:66} {samples:8} {window:7} {mine:9.3f} {shown:>10}", flush=True)


if __name__ == "__main__":
    main()
