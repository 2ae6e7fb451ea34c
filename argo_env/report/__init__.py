"""Report of a run: its record as JSON, and one page for people."""

from argo_env.report.files import write_report

__all__ = ["write_report"]
