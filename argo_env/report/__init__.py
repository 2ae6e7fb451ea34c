"""The report of a run: its record as JSON, and one page that a person reads."""

from argo_env.report.files import write_report

__all__ = ["write_report"]
