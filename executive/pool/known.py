"""The selection policies that are registered."""

from __future__ import annotations

from executive.core import plugins
from executive.pool.policies import Policy

DEFAULT_POLICY = "first_fitted"


def policy_names() -> tuple[str, ...]:
    """All that are registered, none of them loaded."""
    return tuple(plugins.found(plugins.POLICIES))


def known_policy(name: str) -> Policy:
    """One of them. KeyError: no such name; PluginError when it cannot be loaded."""
    return plugins.load(plugins.POLICIES, name, Policy)
