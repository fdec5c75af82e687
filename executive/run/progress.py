"""The progress bar of a run."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeElapsedColumn

from executive.core.types import Segment
from executive.record.along import AlongRoute
from executive.record.bus import Listener, harmless
from executive.record.events import Telemetry

EVERY_S = 20.0


@contextmanager
def progress_bar(title: str, route: tuple[Segment, ...], shown: bool) -> Iterator[tuple[Listener, ...]]:
    """A bar on stderr that fills with metres of route, as a listener to events; none if not `shown`."""
    if not shown:
        yield ()
        return
    columns = (
        TextColumn("[bold]{task.description}"),
        BarColumn(),
        TaskProgressColumn(),
        TextColumn("{task.fields[text]}"),
        TimeElapsedColumn(),
    )
    along = AlongRoute(route)
    with Progress(*columns, console=Console(stderr=True)) as bar:
        task = bar.add_task(title, total=max(along.length_m, 1e-6), text="setting up")

        def watch(event: object, time_s: float) -> None:
            along.hear(event, time_s)
            if isinstance(event, Telemetry) and time_s % EVERY_S == 0.0:
                bar.update(task, completed=along.behind_m(), text=_text(along, time_s))

        yield (harmless(watch),)


def _text(along: AlongRoute, time_s: float) -> str:
    to_go_m = along.length_m - along.behind_m()
    return f"mission {time_s / 60:5.1f} min, way-point {along.reached}, {to_go_m:.2f} m to go"
