"""Why a run did what it did: answered from its record alone."""

from executive.explain.explanation import Explanation, explain
from executive.explain.text import as_text

__all__ = ["Explanation", "as_text", "explain"]
