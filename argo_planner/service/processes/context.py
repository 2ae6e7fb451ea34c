"""The context in which the service begins processes."""

from argo_env.worker_processes import context_with

LOADED = tuple(
    f"argo_planner.service.{module}"
    for module in ("runs.worker", "jobs.analysis", "jobs.evaluation", "jobs.order")
)
"""modules of the work that they do"""
CONTEXT = context_with(*LOADED)
