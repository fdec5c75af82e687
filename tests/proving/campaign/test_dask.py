"""The same cases on a Dask cluster; a worker that is killed loses none."""

from __future__ import annotations

import json
import os
import signal
import warnings
from pathlib import Path

import pytest

from executive.cli import invoke
from executive.run import app
from proving.campaign.cases import case_number, resolved
from proving.campaign.file import load_campaign
from proving.campaign.folder import read_journal
from proving.campaign.run import Watcher

distributed = pytest.importorskip("distributed", reason="the extra dask is not installed")
pytestmark = pytest.mark.filterwarnings("default")  # distributed's own
ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture
def cluster(monkeypatch):
    """A scheduler and two worker processes of one thread each."""
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
        ) as made:
            yield made


def test_a_killed_worker_loses_no_case_and_cases_come_out_as_locally(cluster, write, tmp_path, monkeypatch):
    file, remote = write(runs=8), tmp_path / "remote"
    killed = []

    def kill_a_worker(self, case, tally):
        if len(tally.ended) == 2:
            killed.append(next(iter(cluster.workers.values())).pid)
            os.kill(killed[0], signal.SIGKILL)

    monkeypatch.setattr(Watcher, "ended", kill_a_worker)
    address = cluster.scheduler_address
    options = ["--engine", "dask", "--address", address, "--out", str(remote), "--quiet"]
    assert invoke(["campaign", str(file), *options]) == 0
    assert len(killed) == 1

    ended = read_journal(remote)
    assert sorted(case.number for case in ended) == list(range(8))
    assert all((case.kind, case.verdict) == ("ok", "passed") for case in ended)
    there = {case.number: case.digest for case in ended}
    campaign = load_campaign(file)
    scenario = resolved(campaign, case_number(campaign, 5))
    here = app.run_scenario(scenario, app.RunOptions(out=tmp_path / "here", bar=False, report=False))
    assert here.result.digest == there[5]
    summary = json.loads((remote / "campaign.json").read_text())["summary"]
    assert summary["cases"] == 8


def test_an_address_where_nobody_answers_is_told(write, capsys, monkeypatch):
    monkeypatch.setattr("proving.campaign.dask_engine.CONNECT_S", 1)
    file = write(runs=1)
    options = ["--engine", "dask", "--address", "tcp://127.0.0.1:9", "--quiet"]
    assert invoke(["campaign", str(file), *options]) == 2
    assert "got no Dask scheduler at tcp://127.0.0.1:9" in capsys.readouterr().err
    assert invoke(["campaign", str(file), "--engine", "dask"]) == 2
