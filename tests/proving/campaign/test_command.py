"""`longarm campaign`: exactly the cases asked for, whatever happens to cases or supervisor."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import duckdb
import pytest

from executive.cli import invoke
from executive.record.recorder import Recorder
from proving.campaign.command import _default_folder
from proving.campaign.folder import CampaignFolder, read_journal

ROOT = Path(__file__).resolve().parents[3]
BAD = {"segfault": ("sut", "crash"), "hang": ("sut", "hang"), "eat_memory": ("sut", "memory")}
LIMITS = {"wall": "10 s", "memory": "300 MiB"}


def fault(name):
    return [{name: {}, "from": {"time": "20 s"}}]


def journal(folder):
    return [json.loads(line) for line in (folder / "journal.jsonl").read_text().splitlines()]


def digests(folder):
    return {case.number: case.digest for case in read_journal(folder)}


@pytest.fixture(scope="module")
def compared(tmp_path_factory):
    """A finished campaign of two settings, one of which cannot reach its goal in time."""
    folder = tmp_path_factory.mktemp("compared")
    from tests.proving.campaign.conftest import INLINE, VARY

    content = {"campaign": "small", "scenario": INLINE, "seed": 3, "runs": 2, "vary": VARY}
    content["compare"] = {"as_it_is": {}, "cut_short": {"mission.segments.tolerance": "1 um"}}
    content["limits"] = {"mission": "20 min"}
    (folder / "small.yaml").write_text(json.dumps(content))
    code = invoke(
        ["campaign", str(folder / "small.yaml"), "--out", str(folder / "out"), "-j", "2", "--quiet"]
    )
    return folder / "out", code


def test_each_case_leaves_its_folder_and_the_campaign_its_summary(compared):
    folder, code = compared
    assert code == 1
    assert sorted(path.name for path in folder.iterdir()) == [
        "campaign.json",
        "cases",
        "journal.jsonl",
        "report.html",
    ]
    names = {"scenario.yaml", "files", "result.json", "result.parquet", "record.mcap", "sums.json"}
    for number in range(4):
        assert {path.name for path in (folder / "cases" / f"{number:05d}").iterdir()} == names
    about = json.loads((folder / "campaign.json").read_text())
    assert (about["total"], about["runs"], about["settings"]) == (4, 2, ["as_it_is", "cut_short"])
    shares = about["summary"]["settings"]
    assert [shares[name]["good"] for name in about["settings"]] == [2, 0]
    assert about["summary"]["classes"] == {"ok": 4}


def test_the_table_of_cases_is_read_by_duckdb(compared):
    folder, _ = compared
    rows = duckdb.sql(
        f"""select "case", setting, verdict, seed, drawn_si['mission.segments.off_track'] as margin_m,
        strategies, faults, digest from read_parquet('{folder}/cases/*/result.parquet') order by "case" """
    ).fetchall()
    assert [(row[0], row[1], row[2]) for row in rows] == [
        (0, "as_it_is", "passed"),
        (1, "cut_short", "failed"),
        (2, "as_it_is", "passed"),
        (3, "cut_short", "failed"),
    ]
    assert rows[0][3] == rows[1][3] != rows[2][3], "the settings of a pair share the seed"
    assert all(0.2 <= row[4] <= 0.3 for row in rows)
    assert {row[0]: row[7] for row in rows} == digests(folder)


def test_a_case_rerun_is_identical_or_its_first_divergence_is_named(compared, capsys, tmp_path):
    folder, _ = compared
    assert invoke(["campaign", "rerun", str(folder), "2"]) == 0
    assert capsys.readouterr().out == f"case 2: identical, digest {digests(folder)[2]}\n"
    scenario = (folder / "cases" / "00002" / "scenario.yaml").read_text()
    altered = tmp_path / "altered"
    altered.mkdir()
    (altered / "scenario.yaml").write_text(scenario)
    Recorder(altered / "record.mcap").close()
    assert invoke(["replay", str(altered), "--json"]) == 1
    told = json.loads(capsys.readouterr().out)
    assert (told["identical"], told["divergence"]["recorded"]) == (False, "the end")
    assert invoke(["campaign", "rerun", str(folder), "99"]) == 2
    assert invoke(["replay", str(tmp_path)]) == 2


def test_a_campaign_is_not_begun_over_another_nor_resumed_as_another(compared, capsys):
    folder, _ = compared
    file = folder.parent / "small.yaml"
    assert invoke(["campaign", str(file), "--out", str(folder)]) == 2
    assert "expected --resume, or another folder" in capsys.readouterr().err
    other = folder.parent / "other.yaml"
    other.write_text(file.read_text().replace('"seed": 3', '"seed": 5'))
    assert invoke(["campaign", str(other), "--out", str(folder), "--resume"]) == 2
    assert "got a campaign with another seed" in capsys.readouterr().err
    assert invoke(["campaign", str(file), "--out", str(folder.parent / "none"), "--resume"]) == 2


def test_a_killed_supervisor_loses_nothing_and_repeats_nothing(write, planted, tmp_path):
    """Of nine cases one crashes, one hangs, one eats memory, and the supervisor is killed in the middle."""
    grid = [[], fault("segfault"), [], fault("hang"), [], fault("eat_memory"), [], [], []]
    file, out = write(grid={"faults": grid}, runs=1, limits=LIMITS), tmp_path / "out"
    command = [
        sys.executable,
        "-c",
        "from executive.cli import main; main()",
        "campaign",
        str(file),
    ]
    command += ["--out", str(out), "-j", "2", "--quiet"]
    path = os.pathsep.join([str(ROOT), *(p for p in sys.path if p)])
    first = subprocess.Popen(command, env=os.environ | {"PYTHONPATH": path})
    while not (out / "journal.jsonl").is_file() or len(read_journal(out)) < 4:
        with pytest.raises(subprocess.TimeoutExpired):
            first.wait(timeout=0.05)
    first.send_signal(signal.SIGKILL)
    first.wait()
    before = digests(out)
    written = {n: (out / "cases" / f"{n:05d}" / "result.json").stat().st_mtime_ns for n in before}
    assert 4 <= len(before) < 9
    with (out / "journal.jsonl").open("a") as torn:
        torn.write('{"event": "ended", "case": 8, "cl')  # as a power cut would leave it

    assert invoke(["campaign", str(file), "--out", str(out), "-j", "2", "--quiet", "--resume"]) == 1
    ended = [line for line in journal(out) if line["event"] == "ended"]
    assert sorted(line["case"] for line in ended) == list(range(9))
    assert len(list((out / "cases").iterdir())) == 9
    classes = {line["case"]: (line["class"], line["cause"]) for line in ended}
    assert [classes[n] for n in (1, 3, 5)] == list(BAD.values())
    assert all(classes[n] == ("ok", "") for n in (0, 2, 4, 6, 7, 8))
    for number, when in written.items():
        assert (out / "cases" / f"{number:05d}" / "result.json").stat().st_mtime_ns == when
    rows = duckdb.sql(f"select class, count(*) from read_parquet('{out}/cases/*/*.parquet') group by class")
    assert sorted(rows.fetchall()) == [("ok", 6), ("sut", 3)]


def test_a_kill_between_the_rename_and_the_journal_does_not_lose_the_case(compared, tmp_path):
    folder, _ = compared
    copy = tmp_path / "copy"
    subprocess.run(["cp", "-r", str(folder), str(copy)], check=True)
    lines = (copy / "journal.jsonl").read_text().splitlines(keepends=True)
    (copy / "journal.jsonl").write_text("".join(line for line in lines if '"ended", "case": 1,' not in line))
    about = json.loads((copy / "campaign.json").read_text())
    resumed = CampaignFolder(copy)
    done = resumed.resume(about)
    resumed.close()
    assert sorted(case.number for case in done) == [0, 1, 2, 3]
    assert digests(copy) == digests(folder)


def test_ctrl_c_says_how_to_go_on(write, capsys, monkeypatch):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    file = write(runs=3)
    monkeypatch.setattr("proving.campaign.run.settle", interrupted)
    assert invoke(["campaign", str(file), "--quiet"]) == 130
    out = Path("runs/small-3")
    assert capsys.readouterr().err == f"interrupted; to go on: longarm campaign {file} --out {out} --resume\n"
    assert list((out / "cases").iterdir()) == []
    assert not (out / "work").exists()


def test_without_a_folder_named_the_next_free_one_is_taken_or_the_last_resumed(load, tmp_path):
    campaign = load()
    assert _default_folder(campaign, resume=False) == Path("runs/small-3")
    assert _default_folder(campaign, resume=True) == Path("runs/small-3")
    for name in ("small-3", "small-3-2"):
        (tmp_path / "runs" / name).mkdir(parents=True)
    assert _default_folder(campaign, resume=False) == Path("runs/small-3-3")
    assert _default_folder(campaign, resume=True) == Path("runs/small-3-2")


def test_a_campaign_stops_once_enough_is_known(write, capsys):
    file = write(runs=50, stop={"confidence": "80 %", "interval": "35 %"})
    assert invoke(["campaign", str(file), "--json"]) == 0
    about = json.loads(capsys.readouterr().out)
    assert about["summary"]["enough"]
    assert about["summary"]["cases"] < 8
    assert about["total"] == 50
