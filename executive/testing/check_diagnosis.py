"""What every hypothesis and every evidence channel must keep."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from executive.core.errors import Breach
from executive.core.types import PoseEstimate, Reason
from executive.isc import Channel, Comparison, Gaussian, Hypothesis, Innovation, Measured, SinceFix
from executive.isc.attitude import quat_from_heading_tilt
from executive.isc.kind import broken_by_channel, broken_by_hypothesis
from executive.isc.motion import MotionNoise, start

WIDE_SIGMAS = 12.0


class DiagnosisBreach(Breach):
    """The hypothesis or channel broke promises; the message says which."""


def check_hypothesis(hypothesis: Hypothesis) -> None:
    """Raise DiagnosisBreach with every promise not kept; its channels must be registered."""
    likelihoods = [lik for lik in hypothesis.signature.values() if isinstance(lik, Gaussian)]
    broken = tuple(broken_by_hypothesis(hypothesis))
    _raise("hypothesis", hypothesis.name, broken or tuple(_not_normal(likelihoods)))


def check_channel(channel: Channel, comparisons: Sequence[Comparison] = ()) -> None:
    """Raise DiagnosisBreach with every promise not kept.

    It is read off a fix as predicted, a failure, and `comparisons` of your own with the readings it needs.
    """
    broken = tuple(broken_by_channel(channel))
    if not broken and isinstance(channel.nominal, Gaussian):
        broken = tuple(_not_normal([channel.nominal]))
    _raise("channel", channel.name, broken or tuple(_misread(channel, (*samples(), *comparisons))))


def samples() -> tuple[Comparison, ...]:
    """A fix where it was predicted after a turn and a drive, and a failure."""
    quat = quat_from_heading_tilt(0.1, 0.0, 0.0)
    pose = PoseEstimate(100.0, (3.0, 0.0, 0.0), quat, np.eye(6) * 1e-6, "markers", markers=4)
    motion = start(pose, MotionNoise())
    as_predicted = Comparison(
        time_s=100.0,
        motion=motion,
        fix=pose,
        innovation=Innovation.of(motion, pose),
        since=SinceFix(0.3, 0.1, 0.24, 2),
        usual_current_a=0.12,
        markers_expected=4,
    )
    return as_predicted, Comparison(100.0, motion, failure=Reason.BLOCKED)


def _misread(channel: Channel, comparisons: Sequence[Comparison]) -> Iterator[str]:
    for comparison in comparisons:
        what = "a fix" if comparison.fix else "a failure"
        try:
            measured = channel.observe(comparison)
        except Exception as error:  # a plug-in may raise anything
            yield f"observing {what} raised {type(error).__name__}: {error}"
            continue
        if measured is None:
            continue
        if not isinstance(measured, Measured):
            yield f"observing {what} gave {measured!r}, expected a Measured or None"
        elif measured.finite and not 0 < channel.nominal.likelihood(measured) < math.inf:
            yield f"{measured.value!r} of {what} has no nominal likelihood"


def _not_normal(likelihoods: Sequence[Gaussian]) -> Iterator[str]:
    for likelihood in likelihoods:
        reach = WIDE_SIGMAS * likelihood.sigma
        at = np.linspace(likelihood.mean - reach, likelihood.mean + reach, 2001)
        density = [likelihood.likelihood(Measured(float(x))) - likelihood.floor for x in at]
        area = float(np.trapezoid(density, at))
        if abs(area - 1) > 1e-3:
            yield f"{likelihood} integrates to {area:.3f}, expected 1"


def _raise(kind: str, name: str, broken: tuple[str, ...]) -> None:
    if broken:
        raise DiagnosisBreach(f"{kind} {name}", broken)
