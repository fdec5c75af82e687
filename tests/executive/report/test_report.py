import re
import shutil
import xml.etree.ElementTree as ET
from html.parser import HTMLParser

import numpy as np
import pytest

from executive.core.errors import RecordError
from executive.core.types import Point, Segment
from executive.record import Recorder
from executive.record.events import NodeChange, RouteEvent, Start
from executive.report import write_report
from executive.report.axes import Scale, thinned, ticks
from executive.report.frame import MapFrame, corridor, ellipse
from executive.report.gather import gather
from executive.report.spans import leaf_spans, short_names
from tests.executive.record.synthetic import make_run, read_result

VOID = {"meta", "br", "link", "img", "hr"}


class Balanced(HTMLParser):
    """Notes ids, and every end tag that does not close what was opened last."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.ids: list[str] = []
        self.wrong: list[str] = []

    def handle_starttag(self, tag, attrs):
        self.ids += [value for name, value in attrs if name == "id"]
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.ids += [value for name, value in attrs if name == "id"]

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            self.wrong.append(tag)


@pytest.fixture
def run_copy(finished_run, tmp_path):
    return shutil.copytree(finished_run, tmp_path / "run")


@pytest.fixture(scope="module")
def page(finished_run):
    return write_report(finished_run).read_text()


def parsed(page: str) -> Balanced:
    parser = Balanced()
    parser.feed(page)
    return parser


def test_page_is_well_formed_and_ids_are_unique(page):
    parser = parsed(page)
    assert (parser.wrong, parser.open) == ([], [])
    assert len(parser.ids) == len(set(parser.ids))


def test_page_loads_nothing_from_outside(page):
    sources = re.findall(r"(?:src|href|xlink:href)=[\"']([^\"']*)", page) + re.findall(
        r"url\(([^)]*)\)", page
    )
    assert sources
    assert {s.split(":")[0] if ":" in s else s[0] for s in sources} <= {"data", "#"}
    assert "@import" not in page


def test_every_figure_and_table_of_a_full_run_is_there(page):
    ids = parsed(page).ids
    for key in ("map", "insets", "cross", "timeline", "hypotheses", "telemetry", "views"):
        assert key in ids
        assert f"table-{key}" not in ids
    for key in ("waypoints", "strategies", "faults", "expectations", "localisations"):
        assert f"table-{key}" in ids
    assert "could not show" not in page
    assert page.count("<figcaption>") == 7


def test_inline_drawings_are_valid_xml(page):
    drawings = re.findall(r"<svg.*?</svg>", page, re.DOTALL)
    assert len(drawings) > 20
    for drawing in drawings:
        ET.fromstring(drawing)
        assert "nan" not in re.sub(r'href="data:[^"]*"', "", drawing).lower().replace("nano", "")


def test_figures_of_the_result_are_on_the_page(page, finished_run):
    result = read_result(finished_run)
    for error in result["truth"]["waypoint_errors_m"]:
        assert f"{error * 1000:.1f} mm" in page
    assert result["digest"] in page
    assert "longarm run scenario.yaml --seed 7 --tier full" in page


def test_each_localisation_is_on_the_map_with_its_ellipse(page, finished_run):
    count = len(gather(finished_run).fixes)
    drawn = page[page.index('<section id="map"') : page.index('<section id="insets"')]
    assert len(re.findall(r"<title>localisation \d+ at", drawn)) == count


def test_same_folder_gives_the_same_page(run_copy):
    assert write_report(run_copy).read_text() == write_report(run_copy).read_text()


def test_tree_drawing_is_taken_in_without_its_scripts(run_copy):
    drawing = "<?xml version='1.0'?><svg class='given'><script>alert(1)</script><g/></svg>"
    page = write_report(run_copy, drawing).read_text()
    assert "<svg class='given'><g/></svg>" in page
    assert "alert(1)" not in page
    assert parsed(page).wrong == []


def test_missing_truth_is_named_and_no_true_error_is_claimed(run_copy):
    (run_copy / "truth.mcap").unlink()
    (run_copy / "result.json").unlink()
    page = write_report(run_copy).read_text()
    assert "truth.mcap: no truth" in page
    assert "true track</li>" not in page
    assert parsed(page).wrong == []


@pytest.mark.parametrize("share", [0.05, 0.3, 0.6, 0.95])
def test_truncated_record_still_gives_a_report(run_copy, share):
    record = run_copy / "record.mcap"
    content = record.read_bytes()
    record.write_bytes(content[: int(len(content) * share)])
    (run_copy / "result.json").unlink()
    page = write_report(run_copy).read_text()
    assert "record.mcap was cut off" in page
    assert "without a stop" in page
    assert parsed(page).wrong == []


def test_empty_folder_gives_a_report_that_says_what_is_missing(tmp_path):
    page = write_report(tmp_path).read_text()
    for name in ("record.mcap", "truth.mcap", "result.json", "scenario.yaml"):
        assert name in page
    assert "Map: neither a plan nor an estimate was recorded" in page
    assert parsed(page).wrong == []


def test_damaged_result_is_computed_anew(run_copy):
    (run_copy / "result.json").write_text("{")
    page = write_report(run_copy).read_text()
    assert "result.json cannot be read" in page
    assert "3 of 3" in page


def test_absent_folder_is_an_error_for_the_user(tmp_path):
    with pytest.raises(RecordError, match="no such run folder"):
        write_report(tmp_path / "none")


def test_text_of_the_record_cannot_break_the_page(tmp_path):
    nasty = "</script><b>&\"'"
    with Recorder(tmp_path / "record.mcap") as record:
        record.write(Start(nasty, nasty, 1, 1.0), 0.0)
        record.write(RouteEvent((Segment(Point(1, 0), Point(2, 0), 0.03, 0.2, 0.03),)), 0.0)
        record.write(NodeChange(f"root/{nasty}", "failure", nasty, nasty), 3.0)
    page = write_report(tmp_path).read_text()
    assert parsed(page).wrong == []
    assert '<b>&"' not in page


def test_leaves_are_shown_as_the_stretches_they_ran(tmp_path):
    with Recorder(tmp_path / "record.mcap") as record:
        for time_s, path, status in (
            (0, "root", "running"),
            (0, "root/a", "running"),
            (5, "root/a", "success"),
            (5, "root/b", "failure"),
            (7, "root/a", "running"),
            (9, "root", "running"),
        ):
            record.write(NodeChange(path, status), float(time_s))
    spans = leaf_spans(gather(tmp_path))
    assert [(s.start_s, s.end_s, s.kind) for s in spans["root/a"]] == [(0, 5, "success"), (7, 9, "running")]
    assert [(s.start_s, s.end_s, s.kind) for s in spans["root/b"]] == [(5, 5, "failure")]
    assert "root" not in spans


def test_leaves_of_one_name_are_told_apart_by_their_parents():
    names = short_names(["r/a/wait", "r/b/wait", "r/b/trek"])
    assert list(names.values()) == ["a/wait", "b/wait", "trek"]
    names = short_names(["r/selector/mission/look", "r/selector/mission/for_each/sequence/look"])
    assert list(names.values()) == ["mission/look", "for_each/look"]


def test_ellipse_lies_at_its_mahalanobis_distance():
    covariance = np.array([[4e-6, 1e-6], [1e-6, 2e-6]])
    offset = ellipse(1.0, -2.0, covariance, 2.0) - [1.0, -2.0]
    distance = np.einsum("ni,ij,nj->n", offset, np.linalg.inv(covariance), offset)
    assert distance == pytest.approx(np.full(37, 4.0))


def test_corridor_keeps_its_distance_on_both_sides():
    segment = Segment(Point(0, 0), Point(3, 4), 0.1, 0.2, 0.1)
    sides = [segment.offset(x, y).cross_m for x, y in corridor(segment, 0.2)]
    assert sides == pytest.approx([0.2, 0.2, -0.2, -0.2])


def test_map_keeps_one_scale_in_both_directions():
    frame = MapFrame.around(np.array([[0.0, 0.0], [5.0, 0.4]]), 1000.0, 0.2, (300.0, 600.0))
    assert frame.width_px == pytest.approx(1000.0)
    assert frame.height_px == pytest.approx(300.0)
    assert frame.holds(0, 0)
    assert frame.holds(5, 0.4)
    assert frame.x(1) - frame.x(0) == pytest.approx(frame.y(0) - frame.y(1))


def test_thinning_keeps_the_extremes():
    times = np.arange(20_000.0)
    values = np.sin(times / 50)
    values[12_345] = 9.0
    values[777] = np.nan
    kept_times, kept = thinned(times, values)
    assert len(kept) < 1000
    assert np.nanmax(kept) == 9.0
    assert (np.diff(kept_times) > 0).all()


def test_ticks_are_round_and_inside():
    assert ticks(0.0, 43.7, 9) == [0, 5, 10, 15, 20, 25, 30, 35, 40]
    assert ticks(-0.13, 0.13) == pytest.approx([-0.1, -0.05, 0.0, 0.05, 0.1])
    assert Scale(0, 10, 100, 200)(5) == 150


def test_synthetic_runs_of_one_seed_have_one_digest(tmp_path, finished_run):
    again = make_run(tmp_path / "again")
    other = make_run(tmp_path / "other", seed=8)
    assert read_result(again)["digest"] == read_result(finished_run)["digest"]
    assert read_result(other)["digest"] != read_result(finished_run)["digest"]


def test_scenario_is_taken_from_the_record_where_its_file_is_gone(run_copy):
    (run_copy / "scenario.yaml").unlink()
    page = write_report(run_copy).read_text()
    assert "the copy in the record is shown" in page
    assert "scenario: synthetic_traverse" in page


def test_a_long_map_leaves_room_for_labels_at_its_ends():
    long = MapFrame.around(np.array([[0.0, 0.0], [20.0, 0.0]]), 1000.0, 0.2, (300.0, 600.0))
    assert long.x(0.0) == pytest.approx(40.0)
    assert long.x(20.0) == pytest.approx(960.0)
    short = MapFrame.around(np.array([[0.0, 0.0], [2.0, 0.4]]), 1000.0, 0.2, (300.0, 600.0))
    assert short.x(0.0) == pytest.approx(0.2 * short.px_per_m)
