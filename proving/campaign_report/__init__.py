"""The report of a campaign: one offline HTML file made from the campaign folder and nothing else."""

from pathlib import Path

from executive.config.reporter import Reporter

__all__ = ["REPORTER", "write_campaign_report"]


def write_campaign_report(folder: Path) -> Path:
    """Write `report.html` into a campaign folder from what lies there, and return its path.

    RecordError if the folder is none; whatever is missing inside it is named in the report.
    """
    # its statistics take a second to import: more than all else that is registered
    from proving.campaign_report.page import write_page

    return write_page(folder)


REPORTER = Reporter("campaign", "The report of a campaign folder.", write_campaign_report)
