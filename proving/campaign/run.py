"""Runs a campaign: cases to an engine, endings into the folder, until all have ended or enough is known."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import closing
from dataclasses import replace
from typing import Any

from executive.config.source import Source
from executive.core.clock import Stopwatch
from executive.record import versions
from executive.run import ResolvedScenario
from executive.run.resolve import resolve
from proving.campaign.cases import Campaign, Drawn, Prepared, case_number, prepared, put, seed_of
from proving.campaign.folder import CampaignFolder
from proving.campaign.result import CaseNote, CaseResult, write_case
from proving.campaign.row import row_of, write_row
from proving.campaign.tally import Ended, Tally
from proving.engine import Case, Ending, Limits, settle
from proving.judge.verdict import Terms, judged

Begun = Callable[[Case], None]
Engine = Callable[[Iterable[Case], Begun], Generator[Ending, None, None]]
"""Runs cases as long as they come and slots are free; yields how each ended."""
INSIDE = ("physics", "render", "tick")
"""Parts of a run's wall time that are the simulation's own step and the executive's tick."""


_MAY_CHANGE = ("runs", "doc", "stop", "limits")


class Watcher:
    """Who is told how it goes; does nothing by itself."""

    def began(self, total: int, tally: Tally) -> None:
        """The campaign goes on from here."""

    def ended(self, case: Ended, tally: Tally) -> None:
        """A case has ended."""


def about(campaign: Campaign, runs: int, command: str) -> dict[str, Any]:
    """What `campaign.json` says from the beginning."""
    return {
        "schema": 1,
        "campaign": campaign.file.campaign,
        "doc": campaign.file.doc,
        "seed": campaign.file.seed,
        "runs": runs,
        "total": campaign.total(runs),
        "settings": list(campaign.settings),
        "command": command,
        "versions": versions(),
        "limits": campaign.file.limits.model_dump(mode="json"),
        "file": _identity(campaign),
        "scenario": base_of(campaign).dump(),
        "summary": None,
    }


def run_campaign(
    campaign: Campaign, folder: CampaignFolder, engine: Engine, runs: int, done: list[Ended], watcher: Watcher
) -> Tally:
    """Run the cases that have not ended; an exception (Ctrl-C too) leaves a folder to resume from."""
    tally = Tally({case.number: case for case in done})
    campaign_run = _Run(campaign, folder, tally, runs)
    watcher.began(campaign.total(runs), tally)
    with closing(engine(campaign_run.cases(), campaign_run.began)) as endings:
        for ending in endings:
            watcher.ended(campaign_run.ended(ending), tally)
    return tally


def summary(campaign: Campaign, tally: Tally, watch: Stopwatch, ran: int) -> dict[str, Any]:
    """What `campaign.json` says in the end."""
    rule, elapsed_s = campaign.file.stop, watch.elapsed_s()
    return {
        "cases": len(tally.ended),
        "verdicts": tally.verdicts(),
        "classes": tally.classes(),
        "settings": tally.shares(rule.confidence if rule else 0.95),
        "enough": tally.enough(rule),
        "outside_share": tally.outside_share(),
        "elapsed_s": round(elapsed_s, 3),
        "cases_per_hour": round(ran / elapsed_s * 3600.0, 1) if elapsed_s else None,
    }


class _Run:
    """The cases of one campaign between engine and folder."""

    def __init__(self, campaign: Campaign, folder: CampaignFolder, tally: Tally, runs: int) -> None:
        self._campaign, self._folder, self._tally, self._runs = campaign, folder, tally, runs
        self._terms = Terms.of(base_of(campaign))
        self._under_way: dict[str, tuple[Drawn, Prepared]] = {}

    def cases(self) -> Iterator[Case]:
        """The cases still to be run, in order, drawn when asked for; no more once enough is known."""
        limits = self._campaign.file.limits
        for number in range(self._campaign.total(self._runs)):
            if number in self._tally.ended:
                continue
            if self._tally.enough(self._campaign.file.stop):
                return
            drawn = case_number(self._campaign, number)
            folder = self._folder.work(number).absolute()
            ready = prepared(self._campaign, drawn)
            self._under_way[str(number)] = drawn, ready
            yield Case(
                key=str(number),
                file=folder / "scenario.yaml",
                folder=folder,
                text=ready.text,
                limits=Limits(limits.wall, limits.memory),
            )

    def began(self, case: Case) -> None:
        drawn, _ = self._under_way[case.key]
        self._folder.note(
            {"event": "started", "case": drawn.number, "setting": drawn.setting, "seed": drawn.seed}
        )

    def ended(self, ending: Ending) -> Ended:
        """Judge a case and keep it."""
        drawn, ready = self._under_way.pop(ending.case.key)
        settled = settle(ending)
        faults = tuple(replace(fault, kind=ready.kinds.get(fault.name, "")) for fault in settled.faults)
        result = replace(settled, seed=drawn.seed, faults=faults)
        verdict = judged(ending, result, self._terms)
        ended = Ended(
            number=drawn.number,
            setting=drawn.setting,
            seed=drawn.seed,
            verdict=str(verdict.word),
            kind=str(ending.kind),
            cause=ending.cause,
            outcome=result.outcome,
            wall_s=round(ending.wall_s, 3),
            inside_s=round(sum(result.wall.get(part) or 0.0 for part in INSIDE), 3),
            digest=result.digest,
            ended_as=result.ended_as,
        )
        self._write(ending, CaseResult(result, _note(drawn, ending, verdict.message, ended)))
        self._folder.keep(ended)
        self._tally.add(ended)
        return ended

    def _write(self, ending: Ending, result: CaseResult) -> None:
        folder = ending.case.folder
        if not (folder / "scenario.yaml").is_file() and ending.case.text is not None:
            (folder / "scenario.yaml").write_text(ending.case.text)  # what was refused, or never begun
        write_case(folder / "result.json", result)
        write_row(folder / "result.parquet", row_of(self._campaign.file.campaign, result))


def _note(drawn: Drawn, ending: Ending, message: str, ended: Ended) -> CaseNote:
    return CaseNote(
        index=drawn.number,
        setting=drawn.setting,
        verdict=ended.verdict,
        message=message,
        class_=ended.kind,
        cause=ending.cause,
        detail=ending.detail,
        draw=drawn.draw,
        attempts=ending.attempts,
        wall_s=ended.wall_s,
        memory_bytes=ending.memory_bytes,
        drawn=drawn.parameters,
        journal=ended.to_json(),
    )


def base_of(campaign: Campaign) -> ResolvedScenario:
    """The campaign's scenario with nothing put into it but the campaign's first seed."""
    seed = Source(seed_of(campaign.file.seed, 0), {(): campaign.source.at(())})
    return resolve(put(campaign.scenario, "seed", seed))


def _identity(campaign: Campaign) -> dict[str, Any]:
    """The campaign file but for what may change when it is resumed: how much is run, how long it may take."""
    kept = {key: value for key, value in campaign.source.data.items() if key not in _MAY_CHANGE}
    return kept | {"mission_limit_s": campaign.file.limits.mission}
