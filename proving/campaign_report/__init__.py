"""The report of a campaign: one offline HTML file made from the campaign folder and nothing else."""

from executive.config.reporter import Reporter
from proving.campaign_report.page import write_campaign_report

__all__ = ["REPORTER", "write_campaign_report"]

REPORTER = Reporter("campaign", "The report of a campaign folder.", write_campaign_report)
