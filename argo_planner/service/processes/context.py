"""The context in which the service begins processes."""

from argo_env.worker_processes import context_with

CONTEXT = context_with(
    *(
        f"argo_planner.service.{module}"
        for module in ("runs.worker", "jobs.analysis", "jobs.evaluation", "jobs.order")
    )
)
