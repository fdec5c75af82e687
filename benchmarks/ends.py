"""However a run is ended from outside: is the rover at rest, the record readable, and no traceback shown?

    python -m benchmarks.ends --out rows.jsonl    # 50 signals, 20 full disks, 20 pairs; goes on where it ends

A signal (SIGTERM, SIGINT, SIGHUP in turn) at a time drawn at random; a disk that takes no more at a size
drawn at random; two runs begun into one folder at once. Exit 1 if one was not as it should be. 8 minutes.
"""

from __future__ import annotations

import argparse
import json
import resource
import signal
import subprocess
import sys
import tempfile
import threading
from collections import Counter
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import numpy as np

from executive.record import History, events
from executive.record.verify import verify

ROOT = Path(__file__).parents[1]
SCENARIO = ROOT / "scenarios" / "clean_hop.yaml"
COMMAND = [
    sys.executable,
    "-c",
    "from executive.cli import main; main()",
    "run",
    str(SCENARIO),
    "--quiet",
    "--out",
]
SIGNALS = (signal.SIGTERM, signal.SIGINT, signal.SIGHUP)
LONGEST_S, LARGEST_BYTES = 9.0, 120_000
COUNTS = {"signal": 50, "full disk": 20, "two writers": 20}


def after_a_signal(folder: Path, chance: np.random.Generator, number: int) -> Iterator[str]:
    """What is wrong after a run was asked to end at a random time."""
    asked = SIGNALS[number % len(SIGNALS)]
    run = _begun(folder)
    threading.Event().wait(float(chance.uniform(0.0, LONGEST_S)))
    run.send_signal(asked)
    code, said = _ended(run)
    if code not in (0, 128 + asked, -asked):  # it had ended; it held; it had not begun to listen
        yield f"exit code {code} after {asked.name}"
    yield from _told(said)
    yield from _left(folder, whole=code in (0, 128 + asked))


def after_a_full_disk(folder: Path, chance: np.random.Generator, number: int) -> Iterator[str]:
    """What is wrong after no file could grow beyond a random size."""
    code, said = _ended(_begun(folder, int(chance.integers(500, LARGEST_BYTES))))
    if code not in (0, 2, 3):
        yield f"exit code {code}"
    if len(said.splitlines()) > 1:
        yield f"{len(said.splitlines())} lines on the screen"
    yield from _told(said)
    yield from _left(folder, whole=code == 0)


def after_two_writers(folder: Path, chance: np.random.Generator, number: int) -> Iterator[str]:
    """What is wrong after two runs were begun into one folder."""
    first = _begun(folder)
    threading.Event().wait(float(chance.uniform(0.0, 2.0)))
    ends = [_ended(run) for run in (first, _begun(folder))]
    if sorted(code for code, _ in ends) != [0, 2]:
        yield f"exit codes {[code for code, _ in ends]}"
    for _, said in ends:
        yield from _told(said)
    yield from _left(folder, whole=True)


def _begun(folder: Path, most_bytes: int | None = None) -> subprocess.Popen[str]:
    limited = None if most_bytes is None else partial(_limit, most_bytes)
    return subprocess.Popen(
        [*COMMAND, str(folder)], stderr=subprocess.PIPE, text=True, preexec_fn=limited, cwd=ROOT
    )


def _limit(most_bytes: int) -> None:
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (most_bytes, most_bytes))


def _ended(run: subprocess.Popen[str]) -> tuple[int, str]:
    _, said = run.communicate(timeout=120)
    return run.returncode, said


def _told(said: str) -> Iterator[str]:
    if "Traceback" in said:
        yield f"a traceback on the screen: {said[-200:]}"


def _left(folder: Path, whole: bool) -> Iterator[str]:
    """What is wrong with what lies in the folder; a run that was let end has left it `whole`."""
    record, result = folder / "record.mcap", folder / "result.json"
    history = History.of(record) if record.is_file() else None
    stop = history.last(events.Stop) if history else None
    if result.is_file() and stop is None:
        yield "a result without a stop"
    if history is None:
        return
    if whole and not result.is_file():
        yield "no result"
    if whole and result.is_file():
        yield from verify(folder).problems
    telemetry = history.last(events.Telemetry)
    if stop is not None and telemetry is not None and telemetry.event.moving:
        yield "the rover moves at the end"
    beside = [path.name for path in folder.iterdir() if path.name.startswith(".") and path.name != ".running"]
    if beside:
        yield f"left behind: {', '.join(beside)}"


WAYS = {"signal": after_a_signal, "full disk": after_a_full_disk, "two writers": after_two_writers}


def main() -> int:
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--out", type=Path, required=True, help="file of rows, one JSON a line")
    arguments.add_argument("--few", type=int, help="so many of each instead")
    chosen = arguments.parse_args()
    lines = chosen.out.read_text().splitlines() if chosen.out.is_file() else []
    rows = [json.loads(line) for line in lines]
    done = {(row["way"], row["number"]) for row in rows}
    with chosen.out.open("a") as file:
        for way, count in COUNTS.items():
            for number in range(chosen.few or count):
                if (way, number) not in done:
                    chance = np.random.default_rng([len(way), number])
                    with tempfile.TemporaryDirectory() as scratch:
                        problems = list(WAYS[way](Path(scratch, "run"), chance, number))
                    rows.append({"way": way, "number": number, "problems": problems})
                    file.write(json.dumps(rows[-1]) + "\n")
                    file.flush()
    bad = [row for row in rows if row["problems"]]
    for row in bad:
        print(f"{row['way']} {row['number']}: {'; '.join(row['problems'])}")
    print(f"{dict(Counter(row['way'] for row in rows))}: {len(bad)} not as they should be")
    return int(bool(bad))


if __name__ == "__main__":
    sys.exit(main())
