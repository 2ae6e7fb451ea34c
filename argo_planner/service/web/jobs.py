"""Routes for searches for the best order of a mission, and for all kinds of jobs."""

from typing import Annotated

from fastapi import Path, Response
from pydantic import Field

from argo_compiler.base.errors import Invalid, NotFound
from argo_compiler.base.extensions import installed_names
from argo_compiler.base.message import Message
from argo_compiler.base.model import Model
from argo_compiler.reorder.mission_problem import require_known
from argo_compiler.reorder.requirements import Requirements
from argo_planner.service.core.commands import CommandId, ReplacePlan
from argo_planner.service.jobs.job import JOB_ID, AnyJob, OrderJob
from argo_planner.service.web.bodies import JsonBody
from argo_planner.service.web.commands import COMMAND_RESPONSE, execute_command
from argo_planner.service.web.missions import open_valid_plan
from argo_planner.service.web.requests import (
    MadeOn,
    PlanId,
    Planner,
    Service,
    Viewer,
    created_response,
    json_response,
    make_router,
    openapi_links,
)
from argo_planner.service.world.previews import PreviewedMission, preview_mission

MAX_SEARCH_TIME = 600.0
"""in s"""

router = make_router("jobs")

JobId = Annotated[str, Path(pattern=f"^{JOB_ID}$", description="id of the job")]
_JOB = openapi_links("read_job", "cancel_job", "accept_order", id="$response.body#/id")


class OrderAsked(Model):
    """Requirements that an order has to meet, and a time limit of the search."""

    time_limit: float = Field(default=10.0, gt=0, le=MAX_SEARCH_TIME)
    """in s"""
    requirements: Requirements = Requirements()
    solvers: tuple[Annotated[str, Field(max_length=40)], ...] = Field(default=(), max_length=10)
    """names of solvers of installed packages that take part besides Argo's own"""


class OrderAccepted(Model):
    """Command that applies the order that a search has found."""

    id: CommandId


class JobList(Model):
    """Jobs, the newest ones first."""

    jobs: tuple[AnyJob, ...]


@router.post(
    "/missions/{id}/orders",
    operation_id="suggest_order",
    status_code=202,
    response_model=OrderJob,
    responses={202: created_response(OrderJob, _JOB)},
)
async def start_order_search(
    service: Service, visitor: Planner, id: PlanId, asked: JsonBody[OrderAsked]
) -> Response:
    """Start a search for the mission's best order."""
    plan = (await open_valid_plan(service, id)).plan
    known = installed_names("argo.solvers")
    if unknown := [name for name in asked.solvers if name not in known]:
        raise Invalid(
            Message("no installed package offers the solver `{unknown}`", unknown=unknown[0])
        )
    try:
        require_known(plan.mission, asked.requirements)
    except NotFound as error:  # 404 would be about the address
        raise Invalid(str(error)) from None
    job = service.orders.start(
        id,
        plan.revision,
        plan.mission,
        asked.requirements,
        asked.time_limit,
        visitor.author,
        asked.solvers,
    )
    return json_response(job, 202, location=f"/api/jobs/{job.id}")


@router.get("/jobs", operation_id="list_jobs", response_model=JobList)
async def list_jobs(service: Service, _: Viewer) -> Response:
    """Return the running jobs and the last ones that have ended, without their results."""
    return json_response(
        JobList.model_construct(jobs=tuple(job.without_result() for job in service.jobs.all()))
    )


@router.get("/jobs/{id}", operation_id="read_job", response_model=AnyJob)
async def read_job(service: Service, _: Viewer, id: JobId) -> Response:
    """Return the progress and the result of a job."""
    return json_response(service.jobs.job(id))


@router.delete("/jobs/{id}", operation_id="cancel_job", response_model=AnyJob)
async def cancel_job(service: Service, _: Planner, id: JobId) -> Response:
    """Cancel a running job."""
    return json_response(await service.jobs.cancel_running(id))


@router.post("/jobs/{id}/accept", operation_id="accept_order", **COMMAND_RESPONSE)
async def accept_order(
    service: Service,
    visitor: Planner,
    id: JobId,
    accepted: JsonBody[OrderAccepted],
    made_on: MadeOn,
) -> Response:
    """Apply the order that a search has found, as a command that can be undone.

    412 if the mission has changed since the search started, or since the revision in `If-Match`.
    """
    job, mission = service.orders.job_and_new_mission(id)
    room = await service.rooms.open(job.mission)
    command = ReplacePlan.model_construct(
        id=accepted.id, mission=mission, about="a suggested order"
    )
    plan = room.document.plan
    if plan.find_revision_made_by(command, visitor.author) is None:
        for revision in (job.revision, made_on):
            plan.require_newest(revision)
    return await execute_command(room, command, visitor.author, job.revision)


@router.get("/jobs/{id}/preview", operation_id="preview_job", response_model=PreviewedMission)
async def preview_job_paths(service: Service, _: Viewer, id: JobId) -> Response:
    """Return the paths of the mission in the order that a search found; 409 until there is one."""
    mission = service.orders.job_and_new_mission(id)[1]
    obstacles = service.obstacles.present.obstacles
    return json_response(
        await service.run_on_site(preview_mission, service.site, mission, obstacles)
    )
