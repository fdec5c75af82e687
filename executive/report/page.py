"""Puts the figures and tables of a run into one self-contained HTML page."""

from __future__ import annotations

import json
import re
from importlib.resources import files
from pathlib import Path

import numpy as np
from jinja2 import Environment, StrictUndefined
from markupsafe import Markup

from executive.core.files import write_whole
from executive.record.events import Start
from executive.report.cross_track import cross_track_figure
from executive.report.explain.sentence import sentence
from executive.report.figure import Figure
from executive.report.gather import RecordedRun, gather
from executive.report.insets import insets
from executive.report.overview import overview
from executive.report.panels import telemetry
from executive.report.tables import tables
from executive.report.tiles import tiles, tone_of
from executive.report.timeline import hypotheses, timeline
from executive.report.views import views

_FIGURES = (
    (overview, "Map", "neither a plan nor an estimate was recorded"),
    (insets, "At the way-points", "no way-point was reached"),
    (cross_track_figure, "Cross-track error", "no segment was ever under way"),
    (timeline, "Timeline", "no node changed its state"),
    (hypotheses, "Hypotheses", "no hypotheses were weighed"),
    (telemetry, "Telemetry", "no telemetry was recorded"),
    (views, "Through the cameras", "no pictures were recorded"),
)


def write_report(run_dir: Path, tree_svg: str | None = None) -> Path:
    """Write `report.html` into a run folder from what lies there, and return its path.

    `tree_svg` is a drawing of the tree to include. RecordError if the folder is not there; whatever is
    missing inside it is named in the report.
    """
    run = gather(run_dir)
    path = run_dir / "report.html"
    write_whole(path, render(run, tree_svg))
    return path


def render(run: RecordedRun, tree_svg: str | None = None) -> str:
    """The page as text."""
    figures, absent = [], []
    for make, title, otherwise in _FIGURES:
        figure = make(run)
        if figure is None:
            absent.append(f"{title}: {otherwise}")
        else:
            figures.append(figure)
    if tree_svg is not None:
        figures.append(_tree(tree_svg))
    template = Environment(undefined=StrictUndefined, autoescape=True).from_string(_asset("template.html"))
    outcome = run.result.outcome or "unknown"
    return template.render(
        style=Markup(_asset("style.css")),
        script=Markup(_asset("cursor.js")),
        cursor=Markup(_cursor_data(run)),
        name=run.result.scenario or run.folder.name,
        outcome=outcome.replace("_", " "),
        tone=tone_of(outcome),
        sentence=sentence(run.history) if run.history.end_s else None,
        reason=run.result.reason,
        missing=[*run.missing, *absent],
        tiles=tiles(run.result),
        figures=figures,
        tables=tables(run),
        scenario_yaml=run.scenario_yaml,
        repeat=_repeat(run),
        facts=_facts(run),
    )


def _asset(name: str) -> str:
    return files("executive.report").joinpath(name).read_text()


def _tree(drawing: str) -> Figure:
    """The tree's drawing, its XML prologue left off as it stands inside HTML."""
    inline = drawing[max(drawing.find("<svg"), 0) :]
    inline = re.sub(r"<script.*?</script>", "", inline, flags=re.DOTALL)
    caption = (
        "The behaviour tree that ran. Everything that could have happened is drawn; "
        "the timeline shows what did."
    )
    return Figure("tree", "The tree", f"<div class='tree'>{inline}</div>", caption)


def _repeat(run: RecordedRun) -> str:
    tier = run.result.tier
    words = ["longarm run scenario.yaml"]
    if run.result.seed is not None:
        words.append(f"--seed {run.result.seed}")
    if tier:
        words.append(f"--tier {tier}")
    return " ".join(words)


def _facts(run: RecordedRun) -> list[tuple[str, str]]:
    """What identifies the run."""
    start = run.history.last(Start)
    seed = "–" if run.result.seed is None else str(run.result.seed)
    facts = [("seed", seed), ("tier", run.result.tier or "–"), ("digest", run.result.digest or "–")]
    if start is not None and start.event.versions:
        facts.append(("versions", ", ".join(f"{k} {v}" for k, v in start.event.versions.items())))
    return facts


def _cursor_data(run: RecordedRun) -> str:
    """Where the rover was over time, for the cursor that joins charts and map: [[s, m, m], …]."""
    if run.track is not None:
        rows = np.column_stack([run.track.time_s, run.track.position_site_m[:, :2]])
    else:
        rows = np.array([(p.time_s, p.x_m, p.y_m) for p in run.estimates]).reshape(-1, 3)
    kept = rows[:: max(1, len(rows) // 600)]
    return json.dumps([[round(float(v), 4) for v in row] for row in kept if np.isfinite(row).all()])
