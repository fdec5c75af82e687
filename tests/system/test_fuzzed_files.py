"""A file that says anything at all either runs or is refused with the places of what is wrong with it."""

import numpy as np
import pytest

from benchmarks.fuzz_files import SEED, files, mutated, outcome


@pytest.mark.parametrize("number", range(10_000, 10_030))
def test_a_file_changed_at_random_runs_or_is_refused_at_its_places(tmp_path, number):
    chance = np.random.default_rng([SEED, number])
    source = files()[int(chance.integers(len(files())))]
    path = tmp_path / source.name
    path.write_bytes(mutated(source, chance))
    assert not outcome(path).startswith("bad")
