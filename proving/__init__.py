"""Scenarios as tests: fault injection and evidence."""
