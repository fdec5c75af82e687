"""What every localizer must keep."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from executive.core.errors import Breach
from executive.core.ports import Backend, LocaliseRequest, Localizer
from executive.core.types import PoseEstimate, Quality

PATIENCE_TICKS = 3000


class LocalizerBreach(Breach):
    """The localizer breaks promises; the message says which."""


def check_localizer(make: Callable[..., Localizer], backend: Backend, prior: PoseEstimate) -> None:
    """Raise LocalizerBreach with every promise not kept, on a backend whose rover stands near `prior`.

    `make` is what is registered. The backend is let run, and left at rest.
    """
    localizer = make(devices=backend.devices, rig=backend.rig, clock=backend.clock)
    broken = [told for quality in Quality for told in _looked(localizer, backend, prior, quality)]
    backend.safe_stop()
    if broken:
        raise LocalizerBreach(f"localizer {getattr(make, '__name__', make)}", broken)


def _looked(localizer: Localizer, backend: Backend, prior: PoseEstimate, quality: Quality) -> Iterator[str]:
    action, outcome = localizer.locate(LocaliseRequest(quality, prior)), None
    for _ in range(PATIENCE_TICKS):
        outcome = action.poll()
        if outcome is not None:
            break
        backend.advance()
    if outcome is None:
        action.cancel()
        yield f"{quality}: no outcome within {PATIENCE_TICKS} ticks"
        return
    if action.poll() != outcome:
        yield f"{quality}: an outcome, once given, stays the same"
    if outcome.ok and not isinstance(outcome.value, PoseEstimate):
        yield f"{quality}: a fix is a PoseEstimate, got {type(outcome.value).__name__}"
    elif outcome.ok and outcome.value is not None:
        yield from (f"{quality}: {told}" for told in _of_fix(outcome.value, backend))
    elif not outcome.ok and not outcome.detail:
        yield f"{quality}: a refusal says why (detail), got {outcome.reason} alone"


def _of_fix(pose: PoseEstimate, backend: Backend) -> Iterator[str]:
    covariance = np.asarray(pose.covariance)
    numbers = (*pose.position_site_m, *pose.quat_site_body)
    if not np.isfinite(numbers).all() or not np.isfinite(covariance).all():
        yield "a fix is finite"
    elif covariance.shape != (6, 6) or np.linalg.eigvalsh(covariance).min() < 0.0:
        yield "the covariance is 6x6 and positive semi-definite"
    if not 0.0 <= pose.time_s <= backend.clock.now_s:
        yield f"a fix bears the time of its look, got {pose.time_s} s at {backend.clock.now_s} s"
