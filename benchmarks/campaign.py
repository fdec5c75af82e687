"""Campaigns: throughput on one and two slots, cases that go bad, repetition.

    python benchmarks/campaign.py throughput --cases 500    # campaigns/random_faults.yaml, -j 1 and -j 2
    python benchmarks/campaign.py bad --cases 200           # one crashes, one hangs, one eats memory; kill -9
    python benchmarks/campaign.py rerun --cases 20          # the same digests by rerun, and on a Dask cluster

Each ends with exit code 1 if what it is about does not hold: 1.9 times the cases on two slots and less than
15 % of wall time outside the simulation's step and the executive's tick; exactly so many results, the bad
ones classed right; identical digests.
"""

from __future__ import annotations

import argparse
import json
import os
import signal
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryDirectory

from proving.campaign.folder import read_about, read_journal

ROOT = Path(__file__).resolve().parents[1]
CAMPAIGN = ROOT / "campaigns" / "random_faults.yaml"
SHORT = {
    "scenario": "short",
    "backend": "fake",
    "localizer": "overhead",
    "tier": "geometric",
    "mission": {
        "mission": "short",
        "waypoints": [{"x": "2.2 m", "y": "-0.5 m"}, {"x": "2.6 m", "y": "-0.5 m"}],
    },
}
"""On the fake robot: what becomes of the processes is in question, not what becomes of the rover."""
BAD = {"segfault": "crash", "hang": "hang", "eat_memory": "memory"}
LEAST_SPEED_UP, MOST_OUTSIDE = 1.9, 0.15


def campaign(*arguments: object) -> list[str]:
    program = "from executive.cli.command_line import main; main()"
    return [sys.executable, "-c", program, "campaign", *(str(a) for a in arguments), "--quiet"]


def throughput(cases: int, folder: Path) -> bool:
    hourly, outside = {}, {}
    for slots in (1, 2):
        out = folder / f"{slots}"
        subprocess.run(campaign(CAMPAIGN, "--runs", cases, "-j", slots, "--out", out), check=False)
        told = read_about(out)["summary"]
        hourly[slots], outside[slots] = told["cases_per_hour"], told["outside_share"]
        print(
            f"-j {slots}: {told['cases']} cases, {told['elapsed_s']:.0f} s, {hourly[slots]:.0f} an hour, ",
            end="",
        )
        print(f"{outside[slots]:.1%} outside step and tick; {told['verdicts']} {told['classes']}", flush=True)
    ratio = hourly[2] / hourly[1]
    same = {c.number: c.digest for c in read_journal(folder / "1")} == {
        c.number: c.digest for c in read_journal(folder / "2")
    }
    print(f"two slots do {ratio:.2f} times the cases of one; digests {'equal' if same else 'DIFFER'}")
    return ratio >= LEAST_SPEED_UP and outside[1] < MOST_OUTSIDE and same


def bad(cases: int, folder: Path) -> bool:
    environment = planted(folder)
    places = {cases * (i + 1) // 5: name for i, name in enumerate(BAD)}
    faults = [[{places[n]: {}, "from": {"time": "60 s"}}] if n in places else [] for n in range(cases)]
    content = {"campaign": "bad", "scenario": SHORT, "runs": 1, "grid": {"faults": faults}}
    content["limits"] = {"wall": "30 s", "memory": "500 MB"}
    file, out = folder / "bad.yaml", folder / "out"
    file.write_text(json.dumps(content))
    command = campaign(file, "-j", 2, "--out", out)
    first = subprocess.Popen(command, env=environment)
    while len(read_journal(out)) < cases // 2:
        with suppress(subprocess.TimeoutExpired):
            first.wait(timeout=0.2)
    first.send_signal(signal.SIGKILL)
    first.wait()
    before = len(read_journal(out))
    subprocess.run([*command, "--resume"], env=environment, check=False)
    ended = read_journal(out)
    causes = {c.number: c.cause for c in ended if c.kind != "ok"}
    print(
        f"killed after {before} of {cases}; then {len(ended)} results, {len({c.number for c in ended})} cases"
    )
    print(f"classed bad: {causes}, planted {places}")
    return sorted(c.number for c in ended) == list(range(cases)) and causes == {
        n: BAD[name] for n, name in places.items()
    }


def planted(folder: Path) -> dict[str, str]:
    """An environment in which the planted faults of the tests are installed."""
    info = folder / "plugins" / "planted-0.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: planted\nVersion: 0\n")
    lines = "".join(f"{name} = planted:{name.upper()}\n" for name in BAD)
    (info / "entry_points.txt").write_text(f"[longarm.faults]\n{lines}")
    found = [ROOT / "tests" / "proving" / "planted", info.parent, *(p for p in sys.path if p)]
    return os.environ | {"PYTHONPATH": os.pathsep.join(str(p) for p in found)}


def rerun(cases: int, folder: Path) -> bool:
    from distributed import LocalCluster

    local, remote = folder / "local", folder / "remote"
    subprocess.run(campaign(CAMPAIGN, "--runs", cases, "-j", 2, "--out", local), check=False)
    again = [campaign("rerun", local, number)[:-1] for number in range(cases)]
    identical = sum(subprocess.run(command).returncode == 0 for command in again)
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        options = (
            "--runs",
            cases,
            "--out",
            remote,
            "--engine",
            "dask",
            "--address",
            cluster.scheduler_address,
        )
        subprocess.run(campaign(CAMPAIGN, *options), check=False)
    digests = [{c.number: c.digest for c in read_journal(out)} for out in (local, remote)]
    same = digests[0] == digests[1]
    print(f"{identical} of {cases} identical by rerun; on Dask {'the same' if same else 'OTHER'} digests")
    return identical == cases and same


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("what", choices=["throughput", "bad", "rerun"])
    parser.add_argument("--cases", type=int, default=20)
    options = parser.parse_args()
    with TemporaryDirectory() as folder:
        holds = {"throughput": throughput, "bad": bad, "rerun": rerun}[options.what]
        return 0 if holds(options.cases, Path(folder)) else 1


if __name__ == "__main__":
    sys.exit(main())
