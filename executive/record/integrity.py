"""Is a record what was written? Check sums of the records beside them, taken when a run ends."""

from __future__ import annotations

import hashlib
import json
import zlib
from collections.abc import Iterator
from pathlib import Path

from executive.core.errors import DamagedError
from executive.core.files import write_whole

SUMS, RECORDS = "sums.json", ("record.mcap", "truth.mcap")
BLOCK_BYTES = 4096
"""Damage is told to within one such block."""


def write_sums(folder: Path) -> None:
    """Write `sums.json`: size, sha256 and the CRC-32 of every block of each record there is."""
    sums = {name: _sums((folder / name).read_bytes()) for name in RECORDS if (folder / name).is_file()}
    write_whole(folder / SUMS, json.dumps(sums, indent=1) + "\n")


def require_sound(record: Path) -> None:
    """DamagedError, saying where, for a record that is not what its `sums.json` says.

    One without sums is of a run that was killed, or is not part of a run folder: nothing is known of it.
    """
    problems = list(damage(record))
    if problems:
        raise DamagedError(f"{record}: damaged: {'; '.join(problems)}")


def damage(record: Path) -> Iterator[str]:
    """Everything in which a record differs from its sums; nothing where there are none."""
    listing = record.with_name(SUMS)
    if record.name not in RECORDS or not listing.is_file():
        return
    try:
        written = json.loads(listing.read_text())[record.name]
        size, sha256, blocks = written["bytes"], written["sha256"], written["blocks"]
    except (ValueError, KeyError, TypeError):
        yield f"{SUMS} cannot be read"
        return
    content = record.read_bytes()
    if len(content) != size:
        yield f"it has {len(content)} bytes, {size} were written"
    if hashlib.sha256(content).hexdigest() == sha256:
        return
    wrong = [i for i, (a, b) in enumerate(zip(_blocks(content), blocks, strict=False)) if a != b]
    for block in wrong[:3]:
        first = block * BLOCK_BYTES
        yield f"bytes {first} to {min(first + BLOCK_BYTES, len(content))} are not what was written"
    if not wrong and len(content) == size:
        yield f"its check sum is not that of {SUMS}"


def _sums(content: bytes) -> dict[str, object]:
    return {
        "bytes": len(content),
        "sha256": hashlib.sha256(content).hexdigest(),
        "blocks": _blocks(content),
    }


def _blocks(content: bytes) -> list[str]:
    """The CRC-32 of each block, as hexadecimal digits."""
    view = memoryview(content)
    starts = range(0, len(content), BLOCK_BYTES)
    return [f"{zlib.crc32(view[start : start + BLOCK_BYTES]):08x}" for start in starts]
