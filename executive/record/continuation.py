"""A record that was cut off, written anew beside itself, and put in its own place once it holds all of it."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path

from executive.core.errors import RecordError
from executive.record.divergence import Divergence, divergence
from executive.record.events import Resumed, Start
from executive.record.history import History
from executive.record.reader import Message, read_record
from executive.record.recorder import Recorder
from executive.record.topics import Topic

BLOCK_BYTES = 4096
"""What a kill or a full disk may leave torn at the end of a file."""

MESSAGE_BYTES = 31
"""An MCAP message record without its payload: opcode, length, channel, sequence, two times."""


class Diverged(RecordError):
    """What is recorded anew is not what was recorded before the run was cut off."""


class Continuation(Recorder):
    """Takes the same messages again, up to where the record was cut off, then what comes.

    Until then the file at `path` stays as it was, and the new one lies beside it. A message that differs
    raises Diverged, and nothing is written any more; what differs in the last block is torn, and left out.
    """

    def __init__(self, path: Path, caught_up: Callable[[], None]) -> None:
        """`caught_up` is called once all that was left is recorded again, before the file takes its place."""
        self._left = tuple(read_record(path))
        self._whole = len(self._left) - _in_last_block(self._left)
        self._path, self._beside, self._caught_up = path, beside(path), caught_up
        self._taken, self.behind, self.divergence = 0, bool(self._left), None
        super().__init__(self._beside)
        if not self._left:
            self._take_place()

    behind: bool
    """Whether the record still holds more than is recorded anew."""

    divergence: Divergence | None
    """Where the records part, if they do."""

    def _put(self, topic: Topic, name: str, stamp_ns: int, payload: bytes) -> None:
        if self.divergence is not None:
            return  # how a run ends that cannot go on belongs to neither record
        if self.behind:
            self._compare(Message(name, stamp_ns, payload))
        super()._put(topic, name, stamp_ns, payload)
        if self.behind and self._taken == len(self._left):
            self._take_place()

    def _compare(self, new: Message) -> None:
        old = self._left[self._taken]
        if old == new:
            self._taken += 1
        elif self._taken >= self._whole:
            self._left = self._left[: self._taken]  # torn from here on
        else:
            self.divergence = divergence(old, new)
            raise Diverged(f"{self._path}: the run does not come back as it was: {self.divergence}")

    def _take_place(self) -> None:
        self.behind = False
        self.flush()
        self._caught_up()
        os.replace(self._beside, self._path)


def beside(path: Path) -> Path:
    """Where a file is written anew."""
    return path.with_name(f"{path.name}.anew")


def cut_ticks(record: Path) -> tuple[int, ...]:
    """The ticks at the end of which a recorded run was cut off and went on."""
    history = History.of(record)
    start = history.last(Start)
    return tuple(round(at.time_s / start.event.tick_s) for at in history.all(Resumed)) if start else ()


def _in_last_block(messages: Sequence[Message]) -> int:
    """How many messages reach into the last block of their file."""
    reaching, behind = 0, 0
    for message in reversed(messages):
        if behind >= BLOCK_BYTES:
            break
        reaching, behind = reaching + 1, behind + MESSAGE_BYTES + len(message.payload)
    return reaching
