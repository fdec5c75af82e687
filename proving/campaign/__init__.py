"""Campaigns: one scenario many times over, with what varies drawn per case."""
