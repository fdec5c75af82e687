"""What a mission may ask of a fix, before it is driven."""

import pytest

from executive.core.rig import RigCalibration
from executive.core.types import Point
from executive.run.check import check_file
from perception.localizer.best_fix import best_sigma_m
from perception.localizer.spec import FAR_M, LED_STEREO

MISSION = """\
mission: far
segments: {{on_track: 30 mm, off_track: 250 mm, tolerance: 40 mm}}
waypoints: [{{x: {0} m, y: 0 m}}, {{x: {1} m, y: 0 m, tolerance: {2} mm}}]
"""


@pytest.fixture(scope="module")
def rig():
    return RigCalibration()


def test_the_best_fix_is_worse_the_farther_away(rig):
    sigmas = [best_sigma_m(rig, Point(range_m, 1.0)) for range_m in (5.0, 10.0, 15.0, 19.0)]
    assert sigmas == sorted(sigmas)
    assert sigmas[0] < 0.002 < sigmas[-1]


def test_where_it_is_not_computed_it_is_good_to_less_than_any_tolerance(rig):
    assert best_sigma_m(rig, Point(FAR_M, 0.0)) < 0.005
    assert LED_STEREO.best_sigma_m(rig, Point(FAR_M - 0.1, 0.0)) == 0.0


@pytest.mark.parametrize(
    ("start_m", "end_m", "tolerance_mm", "warned"),
    [(9.4, 9.9, 20, 0), (19.3, 19.9, 30, 1), (19.8, 19.9, 30, 2), (13.0, 13.5, 5, 1)],
)
def test_check_warns_of_a_tolerance_finer_than_any_fix(tmp_path, start_m, end_m, tolerance_mm, warned):
    file = tmp_path / "far.yaml"
    file.write_text(MISSION.format(start_m, end_m, tolerance_mm))
    found = check_file(file)
    assert [problem.warning for problem in found] == [True] * warned
    assert all("arrival_uncertain" in problem.message for problem in found)
