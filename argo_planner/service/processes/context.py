"""Multiprocessing context in which the service starts its processes."""

from argo_env.worker_processes import context_with

LOADED = (
    "argo_planner.service.runs.worker",
    "argo_planner.service.jobs.analysis",
    "argo_planner.service.jobs.evaluation",
    "argo_planner.service.jobs.imports",
    "argo_planner.service.jobs.order_search",
    "argo_compiler.script.resolve.importing",
)
"""modules that the processes need for their jobs, loaded before they are forked"""
CONTEXT = context_with(*LOADED)
