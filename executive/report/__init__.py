"""The report of a run: one offline HTML file made from the run folder and nothing else."""

from executive.report.page import write_report

__all__ = ["write_report"]
