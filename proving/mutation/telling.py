"""Progress of a mutation run, a line an event, on stderr."""

from __future__ import annotations

from dataclasses import dataclass

import click

from proving.mutation.trial import Baseline, Found


@dataclass
class Telling:
    """Called with each baseline and each mutant as it ends."""

    quiet: bool
    baselines: int = 0
    mutants: int = 0

    def __call__(self, news: Baseline | Found, total: int) -> None:
        if isinstance(news, Baseline):
            self.baselines += 1
            text = f"as it is: {news.file} {news.account.verdict.word}"
            self.say(self.baselines, total, text)
        else:
            self.mutants += 1
            end = f"{news.killer}: {news.why}" if news.killer else "survived"
            self.say(self.mutants, total, f"{news.mutant.name}: {end}")

    def say(self, number: int, total: int, text: str) -> None:
        if not self.quiet:
            click.echo(f"[{number}/{total}] {text}", err=True)
