"""Why a run did what it did: answered from its record alone."""

from executive.report.explain.explanation import Explanation, explain
from executive.report.explain.sentence import sentence
from executive.report.explain.text import as_text

__all__ = ["Explanation", "as_text", "explain", "sentence"]
