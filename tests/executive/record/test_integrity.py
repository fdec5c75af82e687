"""Nothing that was changed in a record goes unnoticed, whatever the bit, the byte or the end."""

import shutil

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from executive.core.errors import DamagedError, RecordError
from executive.record import History, read_result, write_result
from executive.record.integrity import BLOCK_BYTES, SUMS, damage, write_sums
from executive.record.verify import verify
from tests.executive.record.synthetic import make_run


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sound")
    make_run(folder)
    write_sums(folder)
    return folder


@pytest.fixture
def altered(run, tmp_path):
    return shutil.copytree(run, tmp_path / "run")


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_any_bit_is_noticed_and_told_to_within_its_block(run, tmp_path, data):
    content = bytearray((run / "record.mcap").read_bytes())
    at = data.draw(st.integers(0, len(content) - 1))
    content[at] ^= 1 << data.draw(st.integers(0, 7))
    record = tmp_path / "record.mcap"
    record.write_bytes(content)
    shutil.copy(run / SUMS, tmp_path)
    first = at // BLOCK_BYTES * BLOCK_BYTES
    (words,) = damage(record)
    assert words.startswith(f"bytes {first} to {min(first + BLOCK_BYTES, len(content))} ")
    with pytest.raises(DamagedError, match=f"damaged: bytes {first} to"):
        History.of(record)


@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(share=st.floats(0.0, 0.999))
def test_any_end_that_is_missing_is_noticed(run, tmp_path, share):
    content = (run / "record.mcap").read_bytes()
    kept = content[: int(share * len(content))]
    (tmp_path / "record.mcap").write_bytes(kept)
    (tmp_path / SUMS).unlink(missing_ok=True)
    assert any("incomplete" in problem for problem in verify(tmp_path).problems)
    shutil.copy(run / SUMS, tmp_path)
    assert any("damaged" in problem for problem in verify(tmp_path).problems)


def test_a_run_as_it_was_written_is_sound(run):
    assert verify(run).problems == ()


@pytest.mark.parametrize("name", ["record.mcap", "truth.mcap"])
def test_the_record_of_another_run_is_noticed(altered, tmp_path, name):
    other = make_run(tmp_path / "other", seed=8)
    shutil.copy(other / name, altered)
    assert any(problem.startswith(f"{name}: damaged") for problem in verify(altered).problems)


def test_sums_that_cannot_be_read_are_damage_and_missing_ones_are_told(altered):
    (altered / SUMS).write_text("{}")
    assert any("cannot be read" in problem for problem in verify(altered).problems)
    (altered / SUMS).unlink()
    assert any("is missing" in problem for problem in verify(altered).problems)


def test_a_result_of_another_record_is_noticed(altered):
    from dataclasses import replace

    result = read_result(altered / "result.json")
    write_result(altered / "result.json", replace(result, digest="0" * 64))
    assert verify(altered).problems == ("record.mcap: its digest is not that of result.json",)


def test_a_folder_without_a_run_is_refused(tmp_path):
    with pytest.raises(RecordError, match="expected a run folder"):
        verify(tmp_path)
