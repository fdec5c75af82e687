"""What every hypothesis must keep."""

from __future__ import annotations

from collections.abc import Iterator

from executive.core.errors import Breach


class HypothesisBreach(Breach):
    """The hypothesis breaks promises; the message says which."""


def check_hypothesis(hypothesis: object) -> None:
    """Raise HypothesisBreach with every promise not kept by its declaration."""
    broken = list(_broken_promises(hypothesis))
    if broken:
        raise HypothesisBreach(f"hypothesis {getattr(hypothesis, 'name', hypothesis)}", broken)


def _broken_promises(hypothesis: object) -> Iterator[str]:
    name = str(getattr(hypothesis, "value", getattr(hypothesis, "name", "")))
    if not name.isidentifier():
        yield f"got the name {name!r}, expected an identifier"
    prior = getattr(hypothesis, "prior", None)
    if prior is not None and not 0.0 < prior < 1.0:
        yield f"got the prior {prior}, expected one in (0, 1)"
