"""What every localizer must keep, as one function that names each breach."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from executive.config.localizers import LOCALIZER_KIND, LocalizerRequest, LocalizerSpec
from executive.core.errors import Breach
from executive.core.ports import Action, Backend, LocaliseRequest, Localizer
from executive.core.types import Localisation, Outcome, PoseEstimate, PoseSource, Quality, Reason

BUDGET_S = 900.0
OVERTIME_S = 120.0  # in which an action under way may still end


class LocalizerBreach(Breach):
    """The localizer breaks a promise; the message says which."""


def check_localizer(
    spec: LocalizerSpec, make_backend: Callable[[], Backend], predicted: PoseEstimate, tier: str
) -> None:
    """Localise with default settings on fresh backends of this tier; raises LocalizerBreach.

    `predicted` is where the rover of these backends stands, as well as ground would know it.
    """
    broken = LOCALIZER_KIND.faults_of(spec.name, spec)
    if broken:
        raise LocalizerBreach(f"localizer {spec.name}", broken)
    _expect(not spec.tiers or tier in spec.tiers, f"it works in {spec.tiers}, got the tier {tier}")
    for check in (_a_fix_is_one, _a_tendency_is_no_fix, _cancelled_is_cancelled, _points_at_the_rover):
        backend = make_backend()
        try:
            request = LocalizerRequest(
                backend.devices, backend.rig, backend.clock, spec.settings(), seed=0, tier=tier
            )
            check(spec, spec.make(request), backend, predicted)
        finally:
            backend.safe_stop()
            backend.close()


def _expect(held: bool, promise: str) -> None:
    if not held:
        raise LocalizerBreach("localizer", [promise])


def _ended(action: Action[Localisation], backend: Backend) -> Outcome[Localisation]:
    """Its outcome, within the budget."""
    until_s = backend.clock.now_s + BUDGET_S + OVERTIME_S
    while backend.clock.now_s <= until_s:
        outcome = action.poll()
        if outcome is not None:
            _expect(action.poll() is outcome, "an outcome, once given, stays the same")
            return outcome
        backend.advance()
    raise LocalizerBreach("localizer", [f"a localisation ends within its budget, {BUDGET_S:.0f} s"])


def _pose(outcome: Outcome[Localisation]) -> PoseEstimate:
    found = None if outcome.value is None else outcome.value.pose
    if not outcome.ok or found is None:
        got = f"got {outcome.reason} ({outcome.detail}), pose {found}"
        raise LocalizerBreach("localizer", [f"it finds the rover where it stands; {got}"])
    numbers = [*found.position_site_m, *found.quat_site_body, *found.covariance.ravel()]
    _expect(all(math.isfinite(number) for number in numbers), "a pose is made of numbers")
    _expect(bool((np.linalg.eigvalsh(found.covariance) >= 0).all()), "a covariance is positive")
    return found


def _a_fix_is_one(
    spec: LocalizerSpec, localizer: Localizer, backend: Backend, predicted: PoseEstimate
) -> None:
    asked_s = backend.clock.now_s
    request = LocaliseRequest(Quality.PRECISE, predicted, BUDGET_S)
    pose = _pose(_ended(localizer.locate(request), backend))
    _expect(pose.source in spec.sources, f"a fix bears one of {spec.sources}, got {pose.source!r}")
    _expect(asked_s <= pose.time_s <= backend.clock.now_s, "a pose bears the time at which it was measured")
    most = spec.expected_markers(backend.rig)
    _expect(pose.markers <= most, f"a fix rests on {most} markers at most, got {pose.markers}")


def _a_tendency_is_no_fix(
    spec: LocalizerSpec, localizer: Localizer, backend: Backend, predicted: PoseEstimate
) -> None:
    outcome = _ended(localizer.locate(LocaliseRequest(Quality.TREND, predicted, BUDGET_S)), backend)
    if outcome.ok:  # a rover at rest may well not show
        _expect(_pose(outcome).source == PoseSource.TREND, "a tendency says that it is one")


def _cancelled_is_cancelled(
    spec: LocalizerSpec, localizer: Localizer, backend: Backend, predicted: PoseEstimate
) -> None:
    action = localizer.locate(LocaliseRequest(Quality.PRECISE, predicted, BUDGET_S))
    action.poll()
    action.cancel()
    outcome = _ended(action, backend)
    _expect(outcome.reason is Reason.CANCELLED, f"cancelled, it ends so; got {outcome.reason}")


def _points_at_the_rover(
    spec: LocalizerSpec, localizer: Localizer, backend: Backend, predicted: PoseEstimate
) -> None:
    pan_rad, tilt_rad = localizer.pointing(predicted)
    within = abs(pan_rad) <= math.pi and abs(tilt_rad) <= math.pi / 2
    _expect(within, f"a head can look where it points; got ({pan_rad}, {tilt_rad}) rad")
