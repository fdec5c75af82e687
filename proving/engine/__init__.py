"""Runs scenarios in child processes: whatever becomes of one is known, and nothing becomes of the others."""

from proving.engine.case import Case, CaseClass, Ending, Limits
from proving.engine.post_mortem import settle
from proving.engine.supervisor import run_cases

__all__ = ["Case", "CaseClass", "Ending", "Limits", "run_cases", "settle"]
