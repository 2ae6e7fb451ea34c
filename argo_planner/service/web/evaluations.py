"""Routes for evaluations: to run a mission in many worlds, report, and replay single runs."""

from typing import Annotated

from fastapi import Path, Response

from argo_planner.service.evaluations.replay import ReplayedRun
from argo_planner.service.jobs.evaluation import EvaluationAsked, EvaluationSpec
from argo_planner.service.jobs.job import EvaluationJob
from argo_planner.service.web.bodies import JsonBody
from argo_planner.service.web.faults import require_faults_on_site
from argo_planner.service.web.jobs import JobId
from argo_planner.service.web.missions import open_valid_plan
from argo_planner.service.web.problems import problem_responses
from argo_planner.service.web.requests import (
    REPORT_POLICY,
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

router = make_router("jobs")

RunKey = Annotated[str, Path(pattern=r"^[0-9a-f]{24}$", description="key of the run")]
_JOB = openapi_links(
    "read_job", "cancel_job", "go_on_with_evaluation", "read_evaluation_report",
    "forget_evaluation", id="$response.body#/id",
)  # fmt: skip


@router.post(
    "/missions/{id}/evaluations",
    operation_id="evaluate_mission",
    status_code=202,
    response_model=EvaluationJob,
    responses=problem_responses(412, 428) | {202: created_response(EvaluationJob, _JOB)},
)
async def start_evaluation(
    service: Service,
    visitor: Planner,
    id: PlanId,
    asked: JsonBody[EvaluationAsked],
    made_on: MadeOn,
) -> Response:
    """Start to run the mission in many worlds; 409 while another evaluation is running."""
    document = await open_valid_plan(service, id, made_on)
    plan = document.plan
    spec = EvaluationSpec(
        name=document.name,
        mission=plan.mission,
        site=service.site.reference,
        obstacles=service.obstacles.present.obstacles,
        asked=asked,
    )
    require_faults_on_site(asked.faults, service.site.site, asked.first_seed)
    spec.make_plan(service.site)  # refuses at once what can't be run
    job = await service.evaluations.start(id, plan.revision, spec, visitor.author)
    return json_response(job, 202, location=f"/api/jobs/{job.id}")


@router.post(
    "/jobs/{id}/go_on",
    operation_id="go_on_with_evaluation",
    status_code=202,
    response_model=EvaluationJob,
)
async def resume_evaluation(service: Service, _: Planner, id: JobId) -> Response:
    """Resume an evaluation that was cancelled or interrupted; only missing runs are executed."""
    return json_response(await service.evaluations.resume(id), 202)


@router.delete("/evaluations/{id}", operation_id="forget_evaluation", status_code=204)
async def delete_evaluation(service: Service, _: Planner, id: JobId) -> Response:
    """Delete an evaluation that has ended, with all its rows; 409 while it is running."""
    await service.evaluations.delete(id)
    return Response(status_code=204)


@router.get("/jobs/{id}/runs/{key}", operation_id="replay_run", response_model=ReplayedRun)
async def replay_evaluated_run(service: Service, _: Viewer, id: JobId, key: RunKey) -> Response:
    """Execute a run of an evaluation again, and return its final state and all its entries."""
    return json_response(await service.evaluations.replay(id, key))


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
    """Return the report of an evaluation; if it was ended early, of the runs that there are."""
    content = await service.evaluations.report(id)
    return Response(content, headers=REPORT_POLICY, media_type="text/html")
