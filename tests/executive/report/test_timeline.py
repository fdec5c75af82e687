import re
from html import unescape

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from executive.record import Recorder
from executive.record.events import NodeChange, Placed, PlacedEvent, RouteEvent, Start
from executive.report.gather import gather
from executive.report.injected import stays
from executive.report.lanes import Group, Lane, drawn
from executive.report.overview import overview
from executive.report.spans import Span
from executive.report.timeline import timeline
from tests.executive.record.synthetic import segments

PARTS = st.sampled_from(["sequence", "trek_to", "mission", "recover", "back_off", "loop"])
LEAF_SPANS = st.tuples(st.lists(PARTS, max_size=4), st.integers(0, 60))
PATHS = st.sets(
    LEAF_SPANS.map(lambda leaf: "/".join(["go", *leaf[0], f"leaf_{leaf[1]}"])), min_size=1, max_size=70
)


@pytest.fixture
def recorded(tmp_path):
    """The run of a record with these events, each with its time."""

    def record(*events):
        with Recorder(tmp_path / "record.mcap") as recorder:
            recorder.write(Start("go", "scenario: go", 1, 1.0), 0.0)
            for time_s, event in events:
                recorder.write(event, float(time_s))
        return gather(tmp_path)

    return record


def lanes(html):
    """The paths of all leaves that have a lane."""
    found = (unescape(words).split()[0] for words in re.findall(r"data-find='([^']*)'", html))
    return [path for path in found if path.startswith("go/")]


def test_however_many_leaves_ran_each_has_a_lane(recorded):
    paths = [f"go/mission/step_{n // 9}/leaf_{n}" for n in range(70)] + ["go/call_for_help"]
    figure = timeline(recorded(*((n, NodeChange(path, "success")) for n, path in enumerate(paths))))
    assert sorted(lanes(figure.body)) == sorted(paths)
    assert "<details class='group'>" in figure.body
    assert ">call_for_help</span>" in figure.body


def test_few_leaves_are_shown_without_folding(recorded):
    figure = timeline(recorded(*((n, NodeChange(f"go/leaf_{n}", "failure")) for n in range(5))))
    assert "<details class='group' open>" in figure.body
    assert "5 leaves, 5 failures" in figure.body


@settings(max_examples=50, deadline=None)
@given(PATHS)
def test_whatever_the_groups_no_lane_is_lost(paths):
    span = Span(0.0, 5.0, "success", "fine")
    groups = [Group("all", tuple(Lane(p, p, (span,)) for p in sorted(paths)), open=False)]
    assert sorted(lanes(drawn(groups, 10.0))) == sorted(paths)


def test_what_faults_put_into_the_world_is_on_the_map_where_it_came_to_lie(recorded):
    rock = [(Placed("rock", 3.0, y / 10, 0.08),) for y in range(4)]
    run = recorded(
        (0, RouteEvent(segments())),
        *((10 + n, PlacedEvent("moving_rock", things)) for n, things in enumerate(rock)),
        (20, PlacedEvent("sand_trap", (Placed("soil", 2.5, 0.0, 0.35),))),
        (40, PlacedEvent("sand_trap", ())),
    )
    moved, sand = stays(run)
    assert (moved.things, moved.since_s, moved.until_s) == (rock[-1], 10, None)
    assert (sand.fault, sand.since_s, sand.until_s) == ("sand_trap", 20, 40)
    drawing = overview(run).body
    assert "moving_rock: a rock, radius 80 mm, from 10\u00a0s<" in drawing
    assert "sand_trap: other soil, radius 350 mm, from 20\u00a0s to 40\u00a0s<" in drawing


def test_the_map_is_wide_enough_for_what_lies_beside_the_path(recorded):
    run = recorded((0, RouteEvent(segments())), (1, PlacedEvent("boulder", (Placed("rock", 9.0, 4.0, 0.2),))))
    left, right = (
        float(v) for v in re.findall(r'cx="([\d.]+)"[^>]*class="injected"', overview(run).body) * 2
    )
    assert 0 < left == right < 1100
