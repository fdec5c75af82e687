import json
import re
import xml.etree.ElementTree as ET

import pytest

from executive.cli import invoke
from executive.core.errors import RecordError
from proving.campaign_report import write_campaign_report
from proving.campaign_report.alarms import alarms
from proving.campaign_report.comparison import comparisons
from proving.campaign_report.detection import UNDETECTED, matrix
from proving.campaign_report.gather import gather
from proving.campaign_report.groups import by_fault, ends, success
from proving.campaign_report.listing import rows
from proving.campaign_report.parameters import varied
from proving.campaign_report.worst import ranked, story
from tests.executive.record.synthetic import make_run
from tests.executive.report.test_report import parsed
from tests.proving.campaigns import ON_S, SETTINGS, Told, fault

LED = fault("led_off", "marker_lost", "marker_lost")
MISSED = fault("led_off", None, "marker_lost")
MISTAKEN = fault("slip_burst", "track_asymmetry", "slip_longitudinal", 300.0)


@pytest.fixture(scope="module")
def base(tmp_path_factory):
    return make_run(tmp_path_factory.mktemp("base") / "run")


@pytest.fixture
def told(base, tmp_path):
    return Told(tmp_path / "told", base)


@pytest.fixture
def full(base, tmp_path):
    """Two settings, faults of two kinds, all kinds of end, a lost case; the second setting does better."""
    made = Told(tmp_path / "full", base, SETTINGS)
    for n in range(10):
        faults = ((), (LED,), (MISSED,), (MISTAKEN,), (LED, MISTAKEN))[n % 5]
        for k, setting in enumerate(SETTINGS):
            outcome = "help" if n % 5 == 3 and k == 0 else "reached"
            error_m = 0.9 if outcome == "help" else 0.004 + 0.001 * n - 0.001 * k
            more = {"outcome": outcome, "error_m": error_m, "setting": setting, "seed": n}
            made.case(2 * n + k, faults, sun_deg=20.0 + n, **more)
    made.note(case=20, event="ended", **{"class": "infrastructure"}, detail="disk full", setting="plain")
    return made


def page_of(told):
    return write_campaign_report(told.folder).read_text()


def test_the_page_is_whole_and_loads_nothing_from_outside(full):
    page = page_of(full)
    seen = parsed(page)
    assert seen.wrong == []
    assert len(seen.ids) == len(set(seen.ids))
    assert not re.search(r"(?:src|href)=[\"'](?!data:|#)", page)
    assert "url(http" not in page
    for drawing in re.findall(r"<svg.*?</svg>", page, re.DOTALL):
        ET.fromstring(drawing)
        assert "nan" not in re.sub(r'href="data:[^"]*"', "", drawing).lower()


def test_the_same_folder_gives_the_same_page(full):
    assert page_of(full) == page_of(full)


def test_no_safety_violation_stands_out_and_one_even_more(told):
    told.case(0)
    assert re.search(
        r'tile good"><span class="value">0</span><span class="label">safety violations', page_of(told)
    )
    told.case(
        7, outcome="safe_hold", safety=[{"text": "tilt below 25 deg", "met": False, "robustness": -0.1}]
    )
    page = page_of(told)
    assert re.search(r'tile bad"><span class="value">1</span><span class="label">safety violation<', page)
    assert "case 7" in page
    assert "Unsafe: tilt below 25 deg" in page


def test_a_safety_row_that_nobody_could_judge_is_no_violation(told):
    told.case(0, safety=[{"text": "tether below 10 N", "met": None}])
    assert gather(told.folder).cases[0].unsafe == ()


def test_driving_beyond_the_margin_is_unsafe_where_no_safety_was_judged(told):
    truth = told.result["truth"] | {"driven_beyond_off_track_m": 0.02}
    told.case(0, truth=truth, safety=None)
    (case,) = gather(told.folder).cases
    assert case.unsafe == ("drove 20 mm beyond the off-track margin",)


def test_success_comes_with_its_interval_and_without_what_proves_nothing(told):
    for n in range(8):
        told.case(n)
    told.case(8, outcome="help")
    told.case(9, outcome="time_limit")
    told.case(10, outcome="invalid")
    told.note(case=11, event="ended", **{"class": "infrastructure"})
    campaign = gather(told.folder)
    found = success(campaign.cases)
    assert found.value == 0.8
    assert (found.low, found.high) == pytest.approx((0.4902, 0.9433), abs=1e-4)  # Wilson's, for 8 of 10
    assert ends(campaign.cases) == {"reached": 8, "help": 1, "time_limit": 1, "lost": 1, "invalid": 1}
    assert "8 of 10; 95 % interval 49.0 to 94.3 %" in page_of(told)


def test_a_case_that_broke_the_system_under_test_counts_as_failed(told):
    told.case(0)
    told.note(case=1, event="started")
    told.note(case=1, event="ended", **{"class": "sut"}, detail="hang after 120 s")
    campaign = gather(told.folder)
    assert success(campaign.cases).value == 0.5
    assert story(campaign.cases[1]) == "no fault; lost (sut): hang after 120 s"
    assert "1 broke the system under test" in page_of(told)


def test_faults_are_sorted_by_success_the_hardest_first(full):
    groups = by_fault(gather(full.folder))
    assert [group.label for group in groups] == ["all cases", "without a fault", "slip_burst", "led_off"]
    assert [len(group.cases) for group in groups] == [21, 5, 8, 12]


def test_the_matrix_counts_what_was_taken_for_what(full):
    found = matrix([row for case in gather(full.folder).counted for row in case.faults])
    assert found["led_off"] == {"marker_lost": 8, UNDETECTED: 4}
    assert found["slip_burst"] == {"track_asymmetry": 8}
    cell = re.search(r"<title>led_off taken for marker_lost: 8 of 12</title>", page_of(full))
    assert cell is not None


def test_latencies_count_from_taking_effect_and_never_is_counted(full):
    page = page_of(full)
    assert (
        "led_off: detected after 40 s in the median of 8, never in 4".replace(" s in", "\u00a0s in") in page
    )
    assert "slip_burst: isolated in" not in page
    assert "slip_burst: never isolated, in 8 cases" in page


def test_settings_are_compared_pair_by_pair(full):
    (found,) = comparisons(gather(full.folder))
    assert (found.first, found.second) == SETTINGS
    assert found.pairs.total == 10
    assert (found.pairs.only_first, found.pairs.only_second) == (0, 2)
    assert found.pairs.difference().value == pytest.approx(0.2)
    assert found.error_m.value == pytest.approx(-0.001)
    assert "+20.0 points" in page_of(full)


def test_a_pair_needs_both_its_cases(base, tmp_path):
    made = Told(tmp_path / "odd", base, SETTINGS)
    made.case(0, setting="plain", seed=1)
    made.case(1, setting="other", seed=1, outcome="invalid")
    made.case(2, setting="plain", seed=2)
    (found,) = comparisons(gather(made.folder))
    assert found.couples == ()
    assert parsed(page_of(made)).wrong == []


def test_margins_are_drawn_with_their_limits(told):
    told.case(0)
    (case,) = gather(told.folder).cases
    assert case.off_track_m == 0.25
    assert case.tilt_limit_deg == pytest.approx(28.6479, abs=1e-4)
    page = page_of(told)
    drawn = page[page.index('aria-label="Margins"') :].partition("</svg>")[0]
    assert drawn.count('fill-opacity="0.09"') == 2


def test_the_worst_cases_come_first_with_map_and_command(told):
    told.case(0, error_m=0.001)
    told.case(1, outcome="help", error_m=0.5)
    told.case(2, outcome="help", error_m=1.5)
    told.case(3, outcome="error")
    told.case(4, safety=[{"text": "at rest", "met": False}])
    assert [case.index for case in ranked(gather(told.folder).cases)] == [4, 3, 2, 1, 0]
    page = page_of(told)
    cards = page[
        page.index("<div class='worst'>") : page.index("</figure>", page.index("<div class='worst'>"))
    ]
    assert cards.count('aria-label="Map of case') == 5
    assert "<code>longarm campaign rerun told 4</code>" in cards
    assert "data:image/jpeg" in cards


def test_every_case_is_in_the_table_with_keys_to_sort_by(full):
    campaign = gather(full.folder)
    made = rows(campaign)
    assert [row[0].key for row in made] == [str(n) for n in range(21)]
    errors = [row[6].key for row in made]
    assert errors[20] == ""
    assert float(errors[0]) == 0.004
    assert page_of(full).count("longarm campaign rerun full") >= 21


def test_what_differs_from_case_to_case_is_shown_with_its_success(full):
    (one,) = varied(gather(full.folder))
    assert (one.key, one.unit) == ("world.light.sun_elevation", "deg")
    assert len(one.values) == 20
    assert "world.light.sun_elevation [deg]" in page_of(full)


def test_alarms_are_counted_over_the_time_before_any_fault(told):
    told.case(0, false_alarms=[{"t_s": 50.0, "hypothesis": "poor_view"}], mission_s=3000.0)
    tried = {"hypothesis": "poor_view", "weight": 0.8}
    early, late = {"name": "fresh_look", "t_s": 60.0} | tried, {"name": "back_off", "t_s": ON_S + 10} | tried
    told.case(1, (LED,), strategies=[early, late])
    found = alarms(gather(told.folder))
    assert found.hours == (3000.0 + ON_S) / 3600
    assert (found.total, found.alarmed, found.without_fault) == (1, (0,), 1)
    assert found.strategies == {"fresh_look": 1}
    assert "<td>poor view</td><td>1</td><td>1.00</td>" in page_of(told)


def test_words_of_a_case_cannot_break_the_page(told):
    nasty = "</script><b>&\"'"
    told.case(0, reason=nasty, outcome="help", setting=nasty)
    page = page_of(told)
    assert parsed(page).wrong == []
    assert '<b>&"' not in page


def test_a_folder_with_nothing_run_says_what_is_missing(told):
    (told.folder / "journal.jsonl").unlink()
    page = page_of(told)
    assert parsed(page).wrong == []
    assert "no case was begun" in page
    assert "journal.jsonl: not there" in page


def test_a_cut_off_journal_and_a_damaged_result_are_told(told):
    (told.case(0) / "result.json").write_text("{")
    told.case(1)
    with (told.folder / "journal.jsonl").open("a") as journal:
        journal.write('{"case": 3, "ev')
    assert [case.outcome for case in gather(told.folder).cases] == ["lost", "reached"]
    assert "cases/00000/result.json cannot be read" in page_of(told)


def test_a_case_without_records_still_has_its_card(told):
    folder = told.case(0, outcome="error")
    for name in ("record.mcap", "truth.mcap"):
        (folder / name).unlink()
    assert "no record was left" in page_of(told)


def test_the_report_command_knows_a_campaign_folder(full, capsys):
    assert invoke(["report", str(full.folder)]) == 0
    assert capsys.readouterr().out.strip() == str(full.folder / "report.html")


def test_a_folder_that_is_no_campaign_is_an_error_for_the_user(tmp_path):
    with pytest.raises(RecordError, match=r"no campaign\.json"):
        write_campaign_report(tmp_path)
    (tmp_path / "campaign.json").write_text("{")
    with pytest.raises(RecordError, match="cannot be read"):
        write_campaign_report(tmp_path)


def test_the_settings_stand_in_the_page_as_they_were(full):
    page = page_of(full)
    assert "longarm campaign told.yaml" in page
    assert json.loads((full.folder / "campaign.json").read_text())["doc"] in page
