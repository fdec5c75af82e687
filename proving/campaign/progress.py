"""How a campaign goes, on the terminal: a bar with rate, time to go and verdicts, and a summary."""

from __future__ import annotations

from types import TracebackType
from typing import Any, Self

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from executive.core.clock import Stopwatch
from proving.campaign.run import Watcher
from proving.campaign.tally import Ended, Tally
from proving.judge.verdict import GOOD

_COLOURS = {"passed": "green", "expected failure": "yellow"}


class CampaignBar(Watcher):
    """A bar on stderr; the time to go is that of the cases since this start."""

    def __init__(self, title: str) -> None:
        columns = (TextColumn("[bold]{task.description}"), BarColumn(), MofNCompleteColumn())
        rest = (TextColumn("{task.fields[text]}"), TimeElapsedColumn())
        self._bar = Progress(*columns, *rest, console=Console(stderr=True))
        self._task = self._bar.add_task(title, total=None, text="")
        self._watch, self._before, self._total = Stopwatch(), 0, 0

    def __enter__(self) -> Self:
        self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._bar.stop()

    def began(self, total: int, tally: Tally) -> None:
        self._watch, self._before, self._total = Stopwatch(), len(tally.ended), total
        self._bar.update(self._task, total=total, completed=self._before, text=_counts(tally))

    def ended(self, case: Ended, tally: Tally) -> None:
        rate_s = (len(tally.ended) - self._before) / self._watch.elapsed_s()
        to_go_s = (self._total - len(tally.ended)) / rate_s
        text = f"{rate_s * 3600:.0f}/h, {_duration(to_go_s)} to go, {_counts(tally)}"
        self._bar.update(self._task, completed=len(tally.ended), text=text)
        if case.verdict not in GOOD:
            setting = f" {case.setting}" if case.setting else ""
            cause = f", {case.kind}: {case.cause}" if case.cause else ""
            self._bar.console.print(f"case {case.number}{setting}: {case.verdict}, {case.outcome}{cause}")


def show_summary(about: dict[str, Any], folder: str) -> None:
    """Print what the campaign has come to."""
    console, told = Console(), about["summary"]
    console.print(f"[bold]{about['campaign']}[/]: {told['cases']} of {about['total']} cases")
    for name, share in told["settings"].items():
        low, high = share["interval"]
        if share["share"] is None:
            console.print(f"  {name or 'good'}: no case counts", highlight=False)
            continue
        console.print(
            f"  {name or 'good'}: {share['good']} of {share['cases']} that count, {share['share']:.1%} "
            f"({share['confidence']:.0%} interval {low:.1%} to {high:.1%})",
            highlight=False,
        )
        if untested := share["untested"]:
            good, all_of_them = share["good"] + share["untested_reached"], share["cases"] + untested
            beside = f"the {untested} in which a fault never fired"
            console.print(
                f"  {good} of {all_of_them} with {beside}, by whether they reached the goal", highlight=False
            )
    console.print("  " + ", ".join(f"{count} {word}" for word, count in told["verdicts"].items()))
    console.print("  classes: " + ", ".join(f"{count} {name}" for name, count in told["classes"].items()))
    if told["enough"]:
        console.print("  stopped early: the interval is narrow enough")
    console.print(f"  {told['elapsed_s']:.1f} s, {told['cases_per_hour']:.0f} cases an hour", highlight=False)
    console.print(f"report: {folder}/report.html", highlight=False, soft_wrap=True)


def _counts(tally: Tally) -> str:
    parts = [f"[{_COLOURS.get(word, 'red')}]{n} {word}[/]" for word, n in tally.verdicts().items()]
    return ", ".join(parts)


def _duration(seconds: float) -> str:
    minutes, hours = seconds / 60.0, seconds / 3600.0
    return f"{hours:.1f} h" if hours >= 1 else f"{minutes:.0f} min" if minutes >= 1 else f"{seconds:.0f} s"
