"""The progress bar of a run."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeElapsedColumn

from executive.record.journal import RunJournal

Report = Callable[[RunJournal, float], None]
EVERY_S = 20.0


@contextmanager
def progress_bar(title: str, length_m: float, shown: bool) -> Iterator[Report]:
    """A bar on stderr that fills with metres of route; a silent one if not `shown`."""
    if not shown:
        yield lambda journal, now_s: None
        return
    columns = (
        TextColumn("[bold]{task.description}"),
        BarColumn(),
        TaskProgressColumn(),
        TextColumn("{task.fields[text]}"),
        TimeElapsedColumn(),
    )
    with Progress(*columns, console=Console(stderr=True)) as bar:
        task = bar.add_task(title, total=max(length_m, 1e-6), text="")

        def report(journal: RunJournal, now_s: float) -> None:
            if now_s % EVERY_S:
                return
            text = f"mission {now_s / 60:5.1f} min, way-point {journal.reached}, {journal.to_go_text()}"
            bar.update(task, completed=journal.along_route_m(), text=text)

        yield report
