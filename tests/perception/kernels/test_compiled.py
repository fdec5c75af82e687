"""Machine code kept on disk: it follows the sources, needs no folder, and bears processes side by side."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from perception.kernels.compiled import plain

ROOT = Path(__file__).parents[3]
INNER = "from perception.kernels.compiled import compiled\n@compiled\ndef inner(x):\n    return x + {}\n"
OF_A_TYPE = (
    "from typing import NamedTuple\nfrom perception.kernels.compiled import compiled\n"
    "class {0}(NamedTuple):\n    x: float\n"
    "@compiled\ndef inner_of(pair):\n    return pair.x + 1\ndef inner(x):\n    return inner_of({0}(x))\n"
)
OUTER = (
    "from perception.kernels.compiled import compiled\nfrom inner import inner\n"
    "@compiled\ndef outer(x):\n    return 2 * inner(x)\n"
)


PRINT_OUTER = "from outer import outer; print(outer(1.0), sum(outer.stats.cache_hits.values()))"
"""outer(1.0), and whether its machine code was found on disk."""


def start(folder: Path, cache_folder: Path, code: str = PRINT_OUTER) -> subprocess.Popen:
    paths = os.pathsep.join((str(folder), str(ROOT)))
    environment = {**os.environ, "PYTHONPATH": paths, "NUMBA_CACHE_DIR": str(cache_folder)}
    return subprocess.Popen([sys.executable, "-c", code], env=environment, stdout=-1, stderr=-1, text=True)


def printed(process: subprocess.Popen) -> str:
    out, err = process.communicate(timeout=120)
    assert not process.returncode, err
    return out.strip()


@pytest.fixture
def sources(tmp_path):
    folder = tmp_path / "sources"
    folder.mkdir()
    (folder / "inner.py").write_text(INNER.format(1))
    (folder / "outer.py").write_text(OUTER)
    return folder


def test_code_kept_by_processes_side_by_side_serves_until_a_file_it_calls_changes(sources, tmp_path):
    together = [start(sources, tmp_path / "kept") for _ in range(2)]
    assert [printed(process).split()[0] for process in together] == ["4.0", "4.0"]
    assert printed(start(sources, tmp_path / "kept")) == "4.0 1"
    (sources / "inner.py").write_text(INNER.format(2))
    assert printed(start(sources, tmp_path / "kept")) == "6.0 0"


def test_code_kept_for_a_type_that_is_gone_is_made_anew(sources, tmp_path):
    code = (
        "import inner; from perception.kernels import compiled as c; print(c.uncompiled(), inner.inner(1.0))"
    )
    (sources / "inner.py").write_text(OF_A_TYPE.format("Pair"))
    assert printed(start(sources, tmp_path / "kept", code)) == "['inner_of'] 2.0"
    assert printed(start(sources, tmp_path / "kept", code)) == "[] 2.0"
    (sources / "inner.py").write_text(OF_A_TYPE.format("Couple"))
    assert printed(start(sources, tmp_path / "kept", code)) == "['inner_of'] 2.0"


def test_nothing_is_kept_where_nothing_can_be_written(monkeypatch):
    def nowhere(*args):
        raise RuntimeError("cannot cache function: no locator available")

    monkeypatch.setattr("numba.core.caching.FunctionCache", nowhere)
    from perception.kernels.compiled import compiled

    assert compiled(lambda x: x + 1)(1.0) == 2.0


@pytest.mark.parametrize("values", [np.eye(3, dtype=int), np.ones((4, 6))[::2, ::2], np.eye(3, order="F")])
def test_arrays_of_any_kind_become_the_one_kind(values):
    values.setflags(write=False)
    made = plain(values)
    np.testing.assert_array_equal(made, values)
    assert made.flags.c_contiguous
    assert made.flags.writeable
    assert made.dtype == np.float64
