"""The small safe expressions of tree files and scenarios: arithmetic with units, guards."""
