"""Signal temporal logic over recorded signals: parse a formula, lay a run's signals on one grid, judge."""

from proving.judge.temporal.formula import (
    Always,
    Eventually,
    Formula,
    Until,
    names,
)
from proving.judge.temporal.judgement import Judgement, judge
from proving.judge.temporal.parse import parse_formula
from proving.judge.temporal.trace import SignalTrace, on_one_grid, recorded

__all__ = [
    "Always",
    "Eventually",
    "Formula",
    "Judgement",
    "SignalTrace",
    "Until",
    "judge",
    "names",
    "on_one_grid",
    "parse_formula",
    "recorded",
]
