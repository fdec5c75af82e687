"""Does every file, whatever it says, either run or give located messages? Shipped files, mutated at random.

    python -m benchmarks.fuzz_files --files 500    # seeded; `--from N` goes on, `--keep DIR` keeps the bad

Trees, missions, scenarios, campaigns and project files, each with one to three changes: a key dropped,
doubled, renamed, moved; a value of another type, size, sign or unit; a cycle of references; broken YAML;
another encoding; an end in the middle. Each is checked as `longarm check` does; what has no problem is run
for a few ticks. Bad: an exception that is not LongarmError's, a defect (exit code 3), a problem without a
place. Exit 1 if any was.
"""

from __future__ import annotations

import argparse
import copy
import shutil
import sys
import tempfile
import traceback
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from executive.core.errors import LongarmError
from executive.run import app
from executive.run.check import check_file

ROOT = Path(__file__).parents[1]
FOLDERS = ("trees", "missions", "scenarios", "campaigns", "strategies", "templates/project")
SEED = 20261201
ODD: tuple[Any, ...] = (
    *(
        None,
        True,
        -1,
        0,
        10**30,
        1e-300,
        "",
        " ",
        "x",
        "1 m",
        "-3 kg",
        "1e999 s",
        ".nan",
        "{pose}",
        "{",
        "$seed",
    ),
    *([], [[]], {}, {"x": {}}, ["1 m"], "navigate", "../../etc/passwd", "/", "a/b\0c", "\u202e", "é" * 400),
)
TEXTS = (
    b"\xff\xfe",
    b"\0",
    b"!!python/object:os.system x",
    b"&a [*a]",
    b"%YAML 1.1\n---\n",
    b"? - :\n",
    b"\t- x",
    b"---\n---\n",
)
Chance = np.random.Generator


def files() -> list[Path]:
    """The shipped files that are mutated."""
    return sorted(path for folder in FOLDERS for path in (ROOT / folder).rglob("*.yaml"))


def mutated(path: Path, chance: Chance) -> bytes:
    """The file with one to three changes; now and then the text itself is damaged."""
    data = yaml.safe_load(path.read_text())
    for _ in range(int(chance.integers(1, 4))):
        data = _changed(data, chance)
    text = yaml.safe_dump(data, sort_keys=False, allow_unicode=True).encode("utf-8", "surrogatepass")
    if chance.random() < 0.15:
        at = int(chance.integers(len(text) + 1))
        odd = TEXTS[int(chance.integers(len(TEXTS)))]
        text = (text[:at] + odd + text[at:], text[:at], text.decode().encode("utf-16"))[
            int(chance.integers(3))
        ]
    return text


def _changed(data: Any, chance: Chance) -> Any:
    data = copy.deepcopy(data)
    places = [(holder, key) for holder, key in _places(data)]
    if not places:
        return ODD[int(chance.integers(len(ODD)))]
    holder, key = places[int(chance.integers(len(places)))]
    changes: tuple[Callable[[], None], ...] = (
        lambda: holder.__delitem__(key),
        lambda: holder.__setitem__(key, ODD[int(chance.integers(len(ODD)))]),
        lambda: _rename(holder, key, chance),
        lambda: holder.__setitem__(key, [holder[key], holder[key]]),
        lambda: holder.__setitem__(key, {str(key): holder[key]}),
        lambda: _exchange(holder, key, places, chance),
        lambda: holder.__setitem__(key, _other_number(holder[key], chance)),
    )
    changes[int(chance.integers(len(changes)))]()
    return data


def _places(data: Any) -> list[tuple[Any, Any]]:
    if isinstance(data, dict):
        return [place for key, value in data.items() for place in ((data, key), *_places(value))]
    if isinstance(data, list):
        return [place for index, value in enumerate(data) for place in ((data, index), *_places(value))]
    return []


def _rename(holder: Any, key: Any, chance: Chance) -> None:
    if isinstance(holder, dict):
        word = str(key)
        at = int(chance.integers(len(word) + 1))
        holder[word[:at] + "x" + word[at + 1 :]] = holder.pop(key)


def _exchange(holder: Any, key: Any, places: list[tuple[Any, Any]], chance: Chance) -> None:
    other, its = places[int(chance.integers(len(places)))]
    holder[key], other[its] = copy.deepcopy(other[its]), copy.deepcopy(holder[key])


def _other_number(value: Any, chance: Chance) -> Any:
    factor = (-1, 0, 0.5, 1e3, 1e9)[int(chance.integers(5))]
    if isinstance(value, int | float) and not isinstance(value, bool):
        return value * factor
    if isinstance(value, str) and value.split(" ")[0].replace(".", "").lstrip("-").isdigit():
        number, _, unit = value.partition(" ")
        return f"{float(number) * factor:g} {unit}".strip()
    return value


def outcome(path: Path) -> str:
    """What comes of one file: refused, checked, ran; or how it is bad."""
    try:
        problems = check_file(path)
        if any(not problem.warning for problem in problems):
            located = all(p.line >= 1 and p.column >= 1 and p.file and p.message for p in problems)
            return "refused" if located else "bad: a problem without a place"
        if not any(f"{kind}:" in path.read_text() for kind in ("scenario", "waypoints")):
            return "checked"
        options = app.RunOptions(
            out=path.parent / "run", tier="geometric", overrides=("time_limit=20 s",), bar=False, report=False
        )
        finished = app.run(path, options)
        return "bad: a defect" if finished.exit_code == 3 else "ran"
    except LongarmError as error:
        return "refused by run" if str(error) else "bad: an error without words"
    except Exception as error:
        traceback.print_exception(error, limit=-4)
        return f"bad: {type(error).__name__}"


def main() -> int:
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--files", type=int, default=500)
    arguments.add_argument("--from", type=int, default=0, dest="first")
    arguments.add_argument("--keep", type=Path, help="folder for files that came out bad")
    chosen = arguments.parse_args()
    sources, counts = files(), Counter[str]()
    for number in range(chosen.first, chosen.first + chosen.files):
        chance = np.random.default_rng([SEED, number])
        source = sources[int(chance.integers(len(sources)))]
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, source.name)
            path.write_bytes(mutated(source, chance))
            came = outcome(path)
            counts[came] += 1
            if came.startswith("bad"):
                print(f"{number} ({source.relative_to(ROOT)}): {came}", flush=True)
                if chosen.keep:
                    chosen.keep.mkdir(parents=True, exist_ok=True)
                    shutil.copy(path, chosen.keep / f"{number}-{source.name}")
    print(f"{chosen.files} files from {chosen.first}: {dict(counts.most_common())}")
    return int(any(came.startswith("bad") for came in counts))


if __name__ == "__main__":
    sys.exit(main())
