"""Files are there whole or not at all."""

import errno
import os
import stat
from pathlib import Path

import pytest

from executive.core.files import write_whole


def test_what_was_there_stays_when_the_disk_is_full(tmp_path, monkeypatch):
    path = tmp_path / "result.json"
    write_whole(path, "good")

    def full(*args):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("pathlib.Path.write_bytes", full)
    with pytest.raises(OSError, match="No space left"):
        write_whole(path, "better")
    monkeypatch.undo()
    assert path.read_text() == "good"
    assert os.listdir(tmp_path) == ["result.json"]


def test_a_link_stays_a_link_and_what_it_names_is_written(tmp_path):
    (tmp_path / "there").write_text("old")
    (tmp_path / "here").symlink_to("there")
    write_whole(tmp_path / "here", "new")
    assert (tmp_path / "here").is_symlink()
    assert (tmp_path / "there").read_text() == "new"


def test_what_is_no_file_is_written_to_and_not_replaced():
    path = Path(os.devnull)
    write_whole(path, b"gone")
    assert stat.S_ISCHR(path.stat().st_mode)
