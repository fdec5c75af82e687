"""Injected faults: what a scenario declares, when each begins, and how it wraps what a run is made of."""
