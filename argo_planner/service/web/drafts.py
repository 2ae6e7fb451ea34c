"""Routes for drafts: scripts of which lines are left to decide on."""

from fastapi import Response

from argo_compiler.base.model import Model
from argo_planner.service.drafts.messages import (
    OF_ASIDES,
    ActsOnDraft,
    DraftState,
    DraftSummary,
)
from argo_planner.service.storage.outline import PlanSummary
from argo_planner.service.web.bodies import JsonBody
from argo_planner.service.web.missions import MISSION_LINKS, create_plan
from argo_planner.service.web.problems import problem_responses
from argo_planner.service.web.requests import (
    DraftId,
    MadeOn,
    Planner,
    Service,
    Viewer,
    created_response,
    json_response,
    make_router,
)

router = make_router("drafts", prefix="/api/drafts")


class DraftList(Model):
    """Drafts, the last changed ones first."""

    drafts: tuple[DraftSummary, ...]


@router.get("", operation_id="list_drafts", response_model=DraftList)
async def list_drafts(service: Service, _: Viewer) -> Response:
    """Return a summary of each draft."""
    return json_response(DraftList(drafts=tuple(service.drafts.list_drafts())))


@router.get("/{id}", operation_id="read_draft", response_model=DraftState)
async def read_draft(service: Service, visitor: Viewer, id: DraftId) -> Response:
    """Return a draft line by line; its ETag is the revision."""
    state = await service.drafts.state(id, visitor.key)
    return json_response(state, revision=state.revision)


@router.post(
    "/{id}/acts",
    operation_id="decide_draft",
    response_model=DraftState,
    responses=problem_responses(412, 428),
)
async def decide_on_draft(
    service: Service, visitor: Planner, id: DraftId, given: JsonBody[ActsOnDraft], made_on: MadeOn
) -> Response:
    """Decide on lines of a draft, and return it as it is then. Decisions are on disk."""
    state = await service.drafts.carry_out(id, given.acts, made_on, visitor.key)
    return json_response(state, revision=state.revision)


@router.post(
    "/{id}/mission",
    operation_id="complete_draft",
    status_code=201,
    response_model=PlanSummary,
    responses={201: created_response(PlanSummary, MISSION_LINKS), **problem_responses(412, 428)},
)
async def complete_draft(
    service: Service, visitor: Planner, id: DraftId, made_on: MadeOn
) -> Response:
    """Create the mission of a complete draft, and delete the draft.

    422 with the code `incomplete` if lines are left to decide on.
    """
    stored, imported = await service.drafts.complete_mission(id, made_on, visitor.key)
    # What lines are set aside, people have seen in the draft.
    notes = tuple(note for note in imported.diagnostics if note.code not in OF_ASIDES)
    answer = await create_plan(service, stored.name, imported.mission, notes, stored.text)
    await service.drafts.delete(id)
    return answer


@router.delete("/{id}", operation_id="delete_draft", status_code=204)
async def delete_draft(service: Service, _: Planner, id: DraftId) -> Response:
    """Delete a draft for ever."""
    await service.drafts.delete(id)
    return Response(status_code=204)
