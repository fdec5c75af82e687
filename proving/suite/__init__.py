"""Scenario files as tests: `longarm test`, and the same verdicts for pytest."""
