"""Puts the figures and tables of a campaign into one self-contained HTML page."""

from __future__ import annotations

import json
from importlib.resources import files
from pathlib import Path

from jinja2 import Environment, StrictUndefined
from markupsafe import Markup

from executive.core.files import write_whole
from executive.report.figure import Figure
from proving.campaign_report import listing
from proving.campaign_report.alarms import alarm_table, alarms
from proving.campaign_report.comparison import compared, comparisons
from proving.campaign_report.detection import detection
from proving.campaign_report.forest import forest
from proving.campaign_report.gather import RecordedCampaign, gather
from proving.campaign_report.headline import headline, tiles
from proving.campaign_report.latencies import latencies
from proving.campaign_report.margins import margins
from proving.campaign_report.parameters import parameters
from proving.campaign_report.worst import worst

_FIGURES = (
    (forest, "Success by fault", "no case was begun"),
    (detection, "Detection", "no fault took effect"),
    (latencies, "Latencies", "no fault took effect"),
    (margins, "Margins", "no true track is known"),
    (worst, "Worst cases", "no case was begun"),
    (parameters, "Parameters varied", "no number in the scenario differs from case to case"),
)


def write_page(folder: Path) -> Path:
    """Write `report.html`, as `write_campaign_report` says, and return its path."""
    path = folder / "report.html"
    write_whole(path, render(gather(folder)))
    return path


def render(campaign: RecordedCampaign) -> str:
    """The page as text."""
    figures, absent = [], []
    for make, title, otherwise in _FIGURES:
        figure = make(campaign)
        if figure is None:
            absent.append(f"{title}: {otherwise}")
        else:
            figures.append(figure)
    pairs = [figure for found in comparisons(campaign) if (figure := compared(found)) is not None]
    found = alarms(campaign)
    template = Environment(undefined=StrictUndefined, autoescape=True).from_string(_asset("template.html"))
    return template.render(
        style=Markup(files("executive.report").joinpath("style.css").read_text() + _asset("campaign.css")),
        script=Markup(_asset("table.js")),
        name=campaign.name,
        doc=campaign.about.get("doc"),
        missing=[*campaign.missing, *absent],
        headline=headline(campaign),
        tiles=tiles(campaign, found),
        figures=_ordered(figures, pairs),
        alarms=alarm_table(found),
        header=listing.HEADER,
        rows=listing.rows(campaign),
        repeat=_command(campaign),
        settings=json.dumps(campaign.about, indent=2, ensure_ascii=False),
    )


def _asset(name: str) -> str:
    return files("proving.campaign_report").joinpath(name).read_text()


def _ordered(figures: list[Figure], pairs: list[Figure]) -> list[Figure]:
    """The comparisons right after success, as they are what such a campaign is for."""
    return figures[:1] + pairs + figures[1:]


def _command(campaign: RecordedCampaign) -> str:
    command = campaign.about.get("command")
    return " ".join(command) if isinstance(command, list) else str(command or "not known")
