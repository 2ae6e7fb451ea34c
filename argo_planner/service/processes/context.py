"""Multiprocessing context in which the service starts its processes."""

from argo_env.worker_processes import context_with

LOADED = tuple(
    f"argo_planner.service.{module}"
    for module in (
        "runs.worker",
        "jobs.analysis",
        "jobs.evaluation",
        "jobs.imports",
        "jobs.order_search",
    )
)
"""modules that the processes need for their jobs, loaded before they are forked"""
CONTEXT = context_with(*LOADED)
