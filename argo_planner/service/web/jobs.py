"""Jobs: the best order of a mission, searched for and accepted; and what all jobs have."""

from typing import Annotated

from fastapi import Path, Response
from pydantic import Field

from argo_compiler.base.errors import Invalid, NotFound
from argo_compiler.base.model import Model
from argo_compiler.reorder.mission_problem import require_known
from argo_compiler.reorder.requirements import Requirements
from argo_planner.service.core.commands import CommandId, ReplacePlan
from argo_planner.service.jobs.job import JOB_ID, AnyJob, OrderJob
from argo_planner.service.web.bodies import Sent
from argo_planner.service.web.commands import COMMAND, carried_out
from argo_planner.service.web.missions import sound_plan
from argo_planner.service.web.requests import (
    MadeOn,
    PlanId,
    Planner,
    Service,
    Viewer,
    created,
    links,
    routes,
    said,
)
from argo_planner.service.world.previews import PreviewedMission, preview_mission

LONGEST_SEARCH = 600.0
"""s"""

router = routes("jobs")

JobId = Annotated[str, Path(pattern=f"^{JOB_ID}$", description="id of the job")]
_JOB = links("read_job", "cancel_job", "accept_order", id="$response.body#/id")


class OrderAsked(Model):
    """What an order has to keep to besides its mission, and how long to search."""

    time_limit: float = Field(default=10.0, gt=0, le=LONGEST_SEARCH)
    """s"""
    requirements: Requirements = Requirements()


class OrderAccepted(Model):
    """A command that puts the mission into the order that was found."""

    id: CommandId


class JobList(Model):
    """Jobs, the newest ones first."""

    jobs: tuple[AnyJob, ...]


@router.post(
    "/missions/{id}/orders",
    operation_id="suggest_order",
    status_code=202,
    response_model=OrderJob,
    responses={202: created(OrderJob, _JOB)},
)
async def suggest_order(
    service: Service, visitor: Planner, id: PlanId, asked: Sent[OrderAsked]
) -> Response:
    """Begins to search for the mission's best order."""
    plan = (await sound_plan(service, id)).plan
    try:
        require_known(plan.mission, asked.requirements)
    except NotFound as error:  # the address is right
        raise Invalid(str(error)) from None
    job = service.orders.start(
        id, plan.revision, plan.mission, asked.requirements, asked.time_limit, visitor.author
    )
    return said(job, 202, location=f"/api/jobs/{job.id}")


@router.get("/jobs", operation_id="list_jobs", response_model=JobList)
async def list_jobs(service: Service, _: Viewer) -> Response:
    """The jobs under way and the last ones that were, without what came of them."""
    return said(JobList.model_construct(jobs=tuple(job.summary() for job in service.jobs.all())))


@router.get("/jobs/{id}", operation_id="read_job", response_model=AnyJob)
async def read_job(service: Service, _: Viewer, id: JobId) -> Response:
    """How far a job is, and what came of it."""
    return said(service.jobs.job(id))


@router.delete("/jobs/{id}", operation_id="cancel_job", response_model=AnyJob)
async def cancel_job(service: Service, _: Planner, id: JobId) -> Response:
    """Ends a job that is under way."""
    return said(await service.jobs.cancel(id))


@router.post("/jobs/{id}/accept", operation_id="accept_order", **COMMAND)
async def accept_order(
    service: Service,
    visitor: Planner,
    id: JobId,
    accepted: Sent[OrderAccepted],
    made_on: MadeOn,
) -> Response:
    """Puts the mission into the order that was found, as a command that can be undone; 412 where
    the mission has changed since the search began."""
    job, mission = service.orders.find_result(id)
    room = await service.rooms.open(job.mission)
    command = ReplacePlan.model_construct(
        id=accepted.id, mission=mission, about="a suggested order"
    )
    plan = room.document.plan
    if plan.revision_for(command, visitor.author) is None:
        for on in (job.revision, made_on):
            plan.require_newest(on)
    return await carried_out(room, command, visitor.author, job.revision)


@router.get("/jobs/{id}/preview", operation_id="preview_job", response_model=PreviewedMission)
async def preview_job(service: Service, _: Viewer, id: JobId) -> Response:
    """The ways of the mission in the order that a search has found; 409 until there is one."""
    mission = service.orders.find_result(id)[1]
    obstacles = service.obstacles.present.obstacles
    return said(await service.on_site(preview_mission, service.site, mission, obstacles))
