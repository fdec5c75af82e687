"""The search for unsafe evidence runs what it says it runs."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from benchmarks.evidence_cases import EXTENTS, MISSIONS, cases, faults
from benchmarks.evidence_search import read_rows
from benchmarks.evidence_table import Row, table
from executive.config.source import read_text
from executive.run.resolve import resolve_source

ROW = Row("a/permanent/m/0", "a", "permanent", "m", 0, "help", "", True, False, 0.0, 0.1, 0.0, ())


@pytest.mark.parametrize("seed", [0, 1])
def test_every_case_of_a_seed_can_be_run(seed: int) -> None:
    """With the catalogue's severities as with drawn ones: one that is refused would go unnoticed as safe."""
    for case in cases(range(seed, seed + 1)):
        scenario = resolve_source(read_text(case.scenario(), case.key), None, None, ())
        assert scenario.tier == "geometric"


def test_every_fault_comes_for_good_and_for_a_while_on_every_mission() -> None:
    found = list(cases(range(len(MISSIONS))))
    assert {case.mission for case in found} == set(MISSIONS)
    for spec in faults():
        extents = {case.extent for case in found if case.fault == spec.name}
        assert extents == ({"permanent"} if spec.lasting else set(EXTENTS))


def test_a_case_is_drawn_alike_whatever_runs_beside_it() -> None:
    alone = next(iter(cases(range(7, 8), ["encoder_scale"], ["sharp_turns"], ["transient"])))
    among = [case for case in cases(range(9), (), list(MISSIONS)) if case == alone]
    assert [case.scenario() for case in among] == [alone.scenario()]


def test_rows_are_read_back_but_for_a_line_that_was_cut_off(tmp_path: Path) -> None:
    rows = [ROW, replace(ROW, key="b", unsafe=("at rest at the end",), nearest_m=None)]
    file = tmp_path / "rows.jsonl"
    lines = [json.dumps(row.to_json()) for row in rows]
    file.write_text("\n".join([*lines, lines[0][:40]]))
    assert read_rows(file) == rows
    assert read_rows(tmp_path / "none.jsonl") == []


def test_the_table_names_every_run_that_was_unsafe_broke_or_lied() -> None:
    unsafe = replace(ROW, key="u", unsafe=("at rest at the end",), beyond_m=0.07)
    broke = replace(ROW, key="b", cause="hang", reason="no end")
    lied = replace(ROW, key="l", false_m=0.0117)
    text = table([ROW, unsafe, broke, lied])
    assert "unsafe: u: at rest at the end; 70 mm beyond" in text
    assert "hang: b: no end" in text
    assert "falsely reached: l: 11.7 mm outside" in text
