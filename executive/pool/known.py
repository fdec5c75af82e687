"""The selection policies that are registered."""

from __future__ import annotations

from collections.abc import Iterator

from executive.core import registry
from executive.core.registry import Kind
from executive.pool.policies import Policy

DEFAULT_POLICY = "first_fitted"


def broken_by_policy(policy: Policy) -> Iterator[str]:
    """A sentence for each promise not kept."""
    if not policy.name.isidentifier():
        yield f"got the name {policy.name!r}, expected an identifier"
    if not policy.doc.strip():
        yield "it does not say how it chooses (doc)"
    if not callable(policy.choose):
        yield f"it chooses by {policy.choose!r}, expected something to call"


POLICY_KIND: Kind[Policy] = Kind(
    "policy", "policies", "How the pool chooses among strategies.", Policy, check=broken_by_policy
)


def policy_names() -> tuple[str, ...]:
    """All that are registered, none of them loaded."""
    return registry.names(POLICY_KIND)


def known_policy(name: str) -> Policy:
    """One of them. KeyError: no such name; PluginError when it cannot be loaded."""
    return registry.get(POLICY_KIND, name)
