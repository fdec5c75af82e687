"""Does a run that is killed come to the end it would have come to, wherever it is killed?

    python -m benchmarks.resume --out rows.jsonl --kills 30    # of each mission; goes on where the file ends
    python -m benchmarks.resume --out rows.jsonl --count       # what it holds so far

A kill: the run begins in a process of its own, which gets SIGKILL once its record has a size drawn at random,
and is resumed. A cut: its twin's record is cut at a byte drawn at random, as where a disk is full (`full`),
or its last block is overwritten as well (`torn`); then it is resumed. Held against the twin, which was not
killed: the outcome, the record (what was left, then more), the sums, and that nothing was commanded twice.
Exit 1 where one differs. Some ten seconds a kill.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import os
import shutil
import signal
import sys
import tempfile
import zlib
from collections import Counter
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from executive.core.clock import Stopwatch
from executive.record import History, events, read_record, read_result
from executive.record.verify import verify
from executive.run import app
from executive.run.resume import resume

ROOT = Path(__file__).parents[1]
ENDINGS = ("result.json", "report.html", "sums.json", ".running")
BLOCK_BYTES = 4096
MANNERS = ("kill", "kill", "kill", "torn", "full")
MISSIONS = {
    "nominal": ("missions/first_traverse.yaml", "geometric"),
    "hop": ("scenarios/clean_hop.yaml", "geometric"),
    "images": ("missions/short_hop.yaml", "full"),
    "fault: weak motor": ("scenarios/weak_track.yaml", "geometric"),
    "fault: marker out": ("scenarios/marker_out.yaml", "geometric"),
    "strategy: rock": ("scenarios/rock_on_path.yaml", "geometric"),
    "strategy: slip": ("scenarios/turning_on_loose_sand.yaml", "geometric"),
    "strategy: dust": ("scenarios/several/dust_storm.yaml", "geometric"),
    "help: late answer": ("scenarios/link/link_delay.yaml", "geometric"),
    "help: no link": ("scenarios/several/dark_and_no_link.yaml", "geometric"),
}


@dataclass(frozen=True)
class Row:
    """One kill and what became of it."""

    mission: str
    number: int
    manner: str
    at_s: float | None
    """Mission time at which the run was cut off; None where it had ended, or had recorded nothing."""
    outcome: str
    expected: str
    problems: tuple[str, ...]
    looked: bool
    wall_s: float
    over_twin: float
    """Wall time of the resumed run over that of its twin."""


def row(twin: Path, mission: str, number: int, folder: Path) -> Row:
    """Kill a run of the mission, resume it, and hold it against its twin."""
    manner = MANNERS[number % len(MANNERS)]
    chance = np.random.default_rng([zlib.crc32(mission.encode()), number])
    size = int(chance.integers((twin / "record.mcap").stat().st_size))
    expected = read_result(twin / "result.json")
    (_killed if manner == "kill" else _cut)(twin, mission, folder, size, manner, chance)
    before = list(read_record(folder / "record.mcap")) if (folder / "record.mcap").is_file() else []
    if not (folder / "scenario.yaml").is_file() or not (folder / "record.mcap").is_file():
        return Row(mission, number, manner, None, "not begun", expected.outcome, (), False, 0.0, 0.0)
    watch = Stopwatch()
    finished = resume(folder, bar=False)
    wall_s = watch.elapsed_s()
    history = History.of(folder / "record.mcap")
    cuts = history.all(events.Resumed)
    looked = any(at.event.path == "after_a_cut/look" for at in history.all(events.NodeChange))
    return Row(
        mission,
        number,
        manner,
        cuts[0].time_s if cuts else None,
        finished.result.outcome,
        expected.outcome,
        tuple(_problems(folder, before, twin, history, manner)),
        looked,
        round(wall_s, 2),
        round(wall_s / (expected.wall_s or 1.0), 2),
    )


def _problems(folder: Path, before: list, twin: Path, history: History, manner: str) -> Iterator[str]:
    yield from verify(folder).problems
    after = list(read_record(folder / "record.mcap"))
    if manner == "torn":
        known = list(read_record(twin / "record.mcap"))
        while before and before[-1] != known[len(before) - 1]:
            before.pop()
    if after[: len(before)] != before:
        yield "what was recorded before the kill is not what the record begins with"
    commands = history.all(events.Command)
    for cut in history.all(events.Resumed):
        last = next((at.event for at in reversed(commands) if at.time_s <= cut.time_s), None)
        first = next((at.event for at in commands if at.time_s > cut.time_s), None)
        if first is not None and first == last and first.verb == "drive":
            yield f"the drive before the cut at {cut.time_s:g} s is commanded again"
    if read_result(folder / "result.json").truth.driven_beyond_off_track_m:
        yield "driven beyond the margin"


def _killed(twin: Path, mission: str, folder: Path, size: int, manner: str, chance: object) -> None:
    """Run the mission, and send SIGKILL once its record has grown to `size`."""
    child = multiprocessing.get_context("fork").Process(target=_run, args=(mission, folder))
    child.start()
    record = folder / "record.mcap"
    while child.is_alive():
        if record.is_file() and record.stat().st_size >= size:
            os.kill(child.pid or 0, signal.SIGKILL)
            break
        child.join(0.001)
    child.join()


def _cut(twin: Path, mission: str, folder: Path, size: int, manner: str, chance: np.random.Generator) -> None:
    """What a full disk leaves, or a machine that went down while it wrote the last block."""
    shutil.copytree(twin, folder)
    for name in ENDINGS:
        (folder / name).unlink(missing_ok=True)
    whole = (twin / "record.mcap").read_bytes()
    kept = size if manner == "full" else size // BLOCK_BYTES * BLOCK_BYTES
    (folder / "record.mcap").write_bytes(whole[:kept] + chance.bytes(size - kept))


def _run(mission: str, folder: Path) -> app.Finished:
    file, tier = MISSIONS[mission]
    return app.run(ROOT / file, app.RunOptions(out=folder, tier=tier, bar=False, report=False))


def tell(rows: list[Row]) -> bool:
    """Print what the rows hold, by mission; whether every one is as it should be."""
    print(f"{'mission':20} kills  same outcome  problems  looked first  wall time over the twin's, median")
    for mission in MISSIONS:
        these = [each for each in rows if each.mission == mission and each.outcome != "not begun"]
        same = sum(each.outcome == each.expected for each in these)
        wrong, looked = sum(bool(each.problems) for each in these), sum(each.looked for each in these)
        over = f"{np.median([each.over_twin for each in these]):.2f}" if these else ""
        print(f"{mission:20} {len(these):5}  {same:12}  {wrong:8}  {looked:12}  {over}")
    bad = [each for each in rows if each.outcome not in (each.expected, "not begun") or each.problems]
    for each in bad:
        print(
            f"{each.mission} {each.number} ({each.manner}, at {each.at_s} s): {each.outcome}, {each.problems}"
        )
    print(
        f"{len(rows)} kills ({dict(Counter(each.manner for each in rows))}), {len(bad)} not as they should be"
    )
    return not bad


def main() -> int:
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--out", type=Path, required=True, help="file of rows, one JSON a line")
    arguments.add_argument("--kills", type=int, default=30, help="of each mission")
    arguments.add_argument("--mission", action="append", choices=MISSIONS, help="these only")
    arguments.add_argument("--count", action="store_true", help="tell what the file holds, and run nothing")
    chosen = arguments.parse_args()
    lines = chosen.out.read_text().splitlines() if chosen.out.is_file() else []
    rows = [Row(**json.loads(line)) for line in lines]
    done = {(each.mission, each.number) for each in rows}
    missions = [] if chosen.count else chosen.mission or list(MISSIONS)
    with tempfile.TemporaryDirectory() as scratch, chosen.out.open("a") as file:
        twins = {
            name: _run(name, Path(scratch, f"twin-{index}")).folder for index, name in enumerate(missions)
        }
        for number in range(chosen.kills):
            for mission in (name for name in missions if (name, number) not in done):
                folder = Path(scratch, "run")
                rows.append(row(twins[mission], mission, number, folder))
                file.write(json.dumps(asdict(rows[-1])) + "\n")
                file.flush()
                shutil.rmtree(folder, ignore_errors=True)
    return 0 if tell(rows) else 1


if __name__ == "__main__":
    sys.exit(main())
