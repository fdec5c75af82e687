"""A fix that is too good to be true, too old, or no measurement at all is refused with the reason."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from executive.core.types import Array, PoseEstimate
from executive.isc.attitude import quat_from_heading_tilt
from executive.isc.evidence_check import EvidenceCheck, unfit

SIGMAS = np.array([0.002, 0.002, 0.004, 0.01, 0.01, 0.005])
GOOD = np.diag(SIGMAS**2)


def fix(x_m: float, time_s: float, covariance: Array = GOOD) -> PoseEstimate:
    return PoseEstimate(time_s, (x_m, 0.3, 0.0), quat_from_heading_tilt(0.1, 0.0, 0.0), covariance, "markers")


def refusal(check: EvidenceCheck, pose: PoseEstimate, driven_m: float) -> str | None:
    return check.refusal(pose, pose.time_s - 10.0, pose.time_s + 1.0, driven_m)


@given(st.lists(st.floats(0.01, 0.5), min_size=1, max_size=8), st.data())
def test_a_fix_that_repeats_any_earlier_one_after_a_drive_is_refused(
    legs_m: list[float], data: st.DataObject
) -> None:
    check, driven_m = EvidenceCheck(), 0.0
    for number, leg_m in enumerate(legs_m):
        assert refusal(check, fix(2.0 + number, 100.0 * number), driven_m) is None
        driven_m += leg_m
    earlier = data.draw(st.integers(0, len(legs_m) - 1))
    again = fix(2.0 + earlier, 100.0 * len(legs_m))
    assert "equals an earlier one in every digit" in str(refusal(check, again, driven_m))
    again_m = again.x_m + 1e-12  # the last digits of a measurement differ
    assert refusal(check, fix(again_m, again.time_s), driven_m) is None


def test_a_rover_at_rest_may_be_found_in_the_same_place_twice() -> None:
    check = EvidenceCheck()
    assert refusal(check, fix(2.0, 100.0), 1.0) is None
    assert refusal(check, fix(2.0, 200.0), 1.0) is None


def test_a_repeated_fix_does_not_become_new_by_being_repeated_at_rest() -> None:
    check = EvidenceCheck()
    assert refusal(check, fix(2.0, 100.0), 0.0) is None
    assert refusal(check, fix(2.0, 200.0), 0.1) is not None
    assert refusal(check, fix(2.0, 300.0), 0.1) is not None


def test_stamps_must_not_go_back_nor_ahead() -> None:
    check = EvidenceCheck()
    assert check.refusal(fix(2.0, 100.0), 0.0, 101.0, 0.0) is None
    assert "50 s older than the last" in str(check.refusal(fix(2.1, 50.0), 0.0, 160.0, 0.1))
    assert "40 s ahead" in str(check.refusal(fix(2.1, 200.0), 0.0, 160.0, 0.1))
    assert "10 s older than the question" in str(check.refusal(fix(2.1, 150.0), 160.0, 170.0, 0.1))


def _skewed(matrix: Array) -> None:
    matrix[0, 1] += 1e-6


def _correlated(matrix: Array) -> None:
    matrix[0, 1] = matrix[1, 0] = 2e-5


def _negative(matrix: Array) -> None:
    matrix[5, 5] = -1e-6


def _tiny(matrix: Array) -> None:
    matrix[0, 0] = matrix[1, 1] = 1e-18


def _exact(matrix: Array) -> None:
    matrix[:] = 0.0


def _sure_of_its_heading(matrix: Array) -> None:
    matrix[5, 5] = 1e-18


@pytest.mark.parametrize(
    ("spoil", "why"),
    [
        (_skewed, "symmetric"),
        (_correlated, "positive"),
        (_negative, "positive"),
        (_exact, "positive"),
        (_tiny, "smaller than"),
        (_sure_of_its_heading, "smaller than"),
    ],
)
def test_what_cannot_be_a_covariance_is_refused(spoil: Callable[[Array], None], why: str) -> None:
    matrix = GOOD.copy()
    spoil(matrix)
    assert why in str(unfit(matrix))
    assert why in str(refusal(EvidenceCheck(), fix(2.0, 100.0, matrix), 0.0))


@pytest.mark.parametrize("entry", [0, 1, 5])
def test_a_fix_that_claims_a_micrometre_is_not_believed(entry: int) -> None:
    """Neither along one axis nor in heading; the best fix from nearby, 0.4 mm and 1.1 mrad, is."""
    matrix = GOOD.copy()
    matrix[entry, entry] = (1e-6) ** 2
    assert "smaller than anything" in str(unfit(matrix))
    matrix[entry, entry] = (4e-5) ** 2
    assert "smaller than anything" in str(unfit(matrix))
    assert unfit(np.diag(np.array([4e-4, 4e-4, 4e-4, 2e-3, 2e-3, 1.1e-3]) ** 2)) is None


def test_a_place_known_too_well_along_any_direction_is_refused() -> None:
    matrix, (c, s) = GOOD.copy(), (math.cos(0.7), math.sin(0.7))
    axes = np.array([[c, -s], [s, c]])
    matrix[:2, :2] = axes @ np.diag([1e-6**2, 0.01**2]) @ axes.T
    assert min(matrix[0, 0], matrix[1, 1]) > 1e-5
    assert "smaller than anything" in str(unfit(matrix))


@given(st.lists(st.floats(-1.0, 1.0), min_size=36, max_size=36), st.floats(1e-3, 1.0))
def test_every_true_covariance_fits(entries: list[float], scale: float) -> None:
    root = scale * (np.array(entries).reshape(6, 6) + 0.1 * np.eye(6))
    assert unfit(root @ root.T + 1e-6 * np.eye(6)) is None


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_a_covariance_that_is_no_number_is_refused(value: float) -> None:
    matrix = GOOD.copy()
    matrix[1, 1] = value
    assert "no number" in str(refusal(EvidenceCheck(), replace(fix(2.0, 100.0), covariance=matrix), 0.0))
