"""Evaluations: a mission is run in many worlds; what came of it, and each run once more."""

from typing import Annotated

from fastapi import Path, Response

from argo_planner.service.evaluations.replay import ReplayedRun
from argo_planner.service.jobs.evaluation import EvaluationAsked, EvaluationSpec
from argo_planner.service.jobs.job import EvaluationJob
from argo_planner.service.web.bodies import Sent
from argo_planner.service.web.jobs import JobId
from argo_planner.service.web.missions import sound_plan
from argo_planner.service.web.problems import documented
from argo_planner.service.web.requests import (
    REPORT_POLICY,
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

router = routes("jobs")

RunKey = Annotated[str, Path(pattern=r"^[0-9a-f]{24}$", description="key of the run")]
_JOB = links(
    "read_job", "cancel_job", "go_on_with_evaluation", "read_evaluation_report",
    "forget_evaluation", id="$response.body#/id",
)  # fmt: skip


@router.post(
    "/missions/{id}/evaluations",
    operation_id="evaluate_mission",
    status_code=202,
    response_model=EvaluationJob,
    responses=documented(412, 428) | {202: created(EvaluationJob, _JOB)},
)
async def evaluate_mission(
    service: Service, visitor: Planner, id: PlanId, asked: Sent[EvaluationAsked], made_on: MadeOn
) -> Response:
    """Begins to run the mission as it stands in many worlds; 409 while another evaluation is under
    way."""
    document = await sound_plan(service, id, made_on)
    plan = document.plan
    spec = EvaluationSpec(
        name=document.name,
        mission=plan.mission,
        site=service.site.reference,
        obstacles=service.obstacles.present.obstacles,
        asked=asked,
    )
    spec.make_plan(service.site)  # what can't be run is refused at once
    job = await service.evaluations.start(id, plan.revision, spec, visitor.author)
    return said(job, 202, location=f"/api/jobs/{job.id}")


@router.post(
    "/jobs/{id}/go_on",
    operation_id="go_on_with_evaluation",
    status_code=202,
    response_model=EvaluationJob,
)
async def go_on_with_evaluation(service: Service, _: Planner, id: JobId) -> Response:
    """Goes on with an evaluation that was cancelled or interrupted: what has been run is not run
    again."""
    return said(await service.evaluations.resume(id), 202)


@router.delete("/evaluations/{id}", operation_id="forget_evaluation", status_code=204)
async def forget_evaluation(service: Service, _: Planner, id: JobId) -> Response:
    """Deletes an evaluation that is over, with all its rows; 409 while it is under way."""
    await service.evaluations.delete(id)
    return Response(status_code=204)


@router.get("/jobs/{id}/runs/{key}", operation_id="replay_run", response_model=ReplayedRun)
async def replay_run(service: Service, _: Viewer, id: JobId, key: RunKey) -> Response:
    """A run of an evaluation, made once more: all that has happened in it."""
    return said(await service.evaluations.replay(id, key))


@router.get(
    "/jobs/{id}/report",
    operation_id="read_evaluation_report",
    response_class=Response,
    responses={
        200: {
            "description": "the report, as a page",
            "content": {"text/html": {"schema": {"type": "string"}}},
        }
    },
)
async def read_evaluation_report(service: Service, _: Viewer, id: JobId) -> Response:
    """The report of an evaluation; of one that was cut short, of what there is."""
    content = await service.evaluations.report(id)
    return Response(content, headers=REPORT_POLICY, media_type="text/html")
