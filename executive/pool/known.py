"""The selection policies that are registered."""

from __future__ import annotations

from executive.core import registry
from executive.core.registry import Kind
from executive.pool.policies import Policy

DEFAULT_POLICY = "first_fitted"
POLICY_KIND: Kind[Policy] = Kind("policy", "policies", "How the pool chooses among strategies.", Policy)


def policy_names() -> tuple[str, ...]:
    """All that are registered, none of them loaded."""
    return registry.names(POLICY_KIND)


def known_policy(name: str) -> Policy:
    """One of them. KeyError: no such name; PluginError when it cannot be loaded."""
    return registry.get(POLICY_KIND, name)
