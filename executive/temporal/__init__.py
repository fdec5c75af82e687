"""Signal temporal logic over recorded signals: parse a formula, lay a run's signals on one grid, judge."""

from executive.temporal.formula import Always, Eventually, Formula, Until, names
from executive.temporal.judgement import Judgement, judge
from executive.temporal.parse import parse_formula
from executive.temporal.trace import Trace, on_one_grid, recorded

__all__ = [
    "Always",
    "Eventually",
    "Formula",
    "Judgement",
    "Trace",
    "Until",
    "judge",
    "names",
    "on_one_grid",
    "parse_formula",
    "recorded",
]
