"""The report of a campaign: one offline HTML file made from the campaign folder and nothing else."""

from proving.campaign_report.page import write_campaign_report

__all__ = ["write_campaign_report"]
