"""What makes a mission impossible, over generated missions: the lander's keep-out, wide tolerances."""

import math

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from executive.config.mission import FURTHEST_M, NEAREST_M, mission_problems
from executive.config.models import MissionFile
from executive.config.source import read_text
from executive.config.validate import parse

ANGLES = st.floats(-math.pi, math.pi)
POINTS = st.builds(
    lambda r_m, angle: (r_m * math.cos(angle), r_m * math.sin(angle)), st.floats(1.3, 19.0), ANGLES
)


def problems(points, **margins):
    listing = [
        f"  - {{x: {x:.6f} m, y: {y:.6f} m{''.join(f', {k}: {v}' for k, v in more.items())}}}"
        for x, y, more in points
    ]
    defaults = "".join(f", {k}: {v}" for k, v in margins.items())
    text = f"mission: m\nsegments: {{on_track: 10 mm{defaults}}}\nwaypoints:\n" + "\n".join(listing) + "\n"
    source = read_text(text, "m.yaml")
    return list(mission_problems(source, (), parse(source, MissionFile)))


@settings(max_examples=100, deadline=None)
@given(POINTS, POINTS)
def test_a_segment_passes_the_lander_as_far_off_as_its_ends_must(start, end):
    assume(math.dist(start, end) > 0.01)
    found = problems([(*start, {}), (*end, {})])
    nearest_m = min(
        math.hypot(*(a + share / 500 * (b - a) for a, b in zip(start, end, strict=True)))
        for share in range(501)
    )
    if nearest_m < NEAREST_M - 0.02:
        (problem,) = found
        assert (problem.line, "passes the lander" in problem.message) == (5, True)
    if nearest_m > NEAREST_M:
        assert found == []


@pytest.mark.parametrize("distance_m", [0.0, NEAREST_M - 0.01, FURTHEST_M + 0.01])
def test_a_way_point_out_of_reach_is_told_once(distance_m):
    (problem,) = problems([(2.0, 0.0, {}), (distance_m, 0.0, {})])
    assert (problem.line, problem.column) == (5, 5)


@settings(deadline=None)
@given(st.integers(1, 400), st.integers(20, 400), ANGLES)
def test_a_rover_that_has_arrived_stands_inside_the_next_corridor(tolerance_mm, margin_mm, bearing):
    end = (6.0 + math.cos(bearing), math.sin(bearing))
    points = [
        (5.0, 0.0, {}),
        (6.0, 0.0, {"tolerance": f"{tolerance_mm} mm", "off_track": "400 mm"}),
        (*end, {"off_track": f"{margin_mm} mm", "tolerance": "10 mm"}),
    ]
    found = [p for p in problems(points) if "next segment" in p.message]
    assert len(found) == (tolerance_mm > margin_mm)
    assert all(p.line == 5 for p in found)
