"""Routes for the world: its description, meshes, maps and obstacles, and previews of paths."""

from collections.abc import Callable
from typing import Annotated, Any

from fastapi import Path, Request, Response
from pydantic import Field

from argo_compiler.base.catalog import CheckpointKind
from argo_compiler.base.errors import Invalid
from argo_compiler.base.model import Model, Pose
from argo_compiler.il import Task
from argo_planner.service.web.bodies import JsonBody
from argo_planner.service.web.missions import open_valid_plan
from argo_planner.service.web.problems import problem_responses
from argo_planner.service.web.requests import (
    JSON,
    MadeOn,
    PlanId,
    Planner,
    PlanningService,
    Service,
    Viewer,
    file_route_arguments,
    json_response,
    make_router,
)
from argo_planner.service.world.description import WorldDescription, describe_world, world_digest
from argo_planner.service.world.floor_plans import DescribedFloorPlan, describe_floor_plan
from argo_planner.service.world.meshes import Detail, checkpoint_mesh, floor_mesh, robot_mesh
from argo_planner.service.world.obstacle_store import ObstacleList
from argo_planner.service.world.obstacles import MOST_OBSTACLES, Obstacle, with_obstacles
from argo_planner.service.world.previews import (
    PreviewedMission,
    PreviewedWay,
    preview_mission,
    preview_path,
)
from argo_planner.service.world.standing_map import standing_map

GLB = "model/gltf-binary"
MAP = "application/octet-stream"

router = make_router("world")

Floor = Annotated[int, Path(ge=-1_000, le=1_000, description="number of the floor")]


class ObstaclesGiven(Model):
    """All obstacles of the site; they replace the present ones."""

    obstacles: tuple[Obstacle, ...] = Field(max_length=MOST_OBSTACLES)


class WayAsked(Model):
    """Request for a path: to a pose, or to the pose of a task, with its action."""

    start: Pose
    goal: Pose | None = None
    task: Task | None = None


def _cached_file(media: str) -> dict[str, Any]:
    """Return the arguments of a route that responds with a file, or with 304 if it is unchanged."""
    arguments = file_route_arguments("the file", media)
    arguments["responses"][304] = {"description": "the client has the present file"}
    return arguments


@router.get("/world", operation_id="read_world", response_model=WorldDescription)
async def read_world(service: Service, _: Viewer) -> Response:
    """Return the site: floors, checkpoints, docks, named poses, the robot and the obstacles."""
    obstacles = service.obstacles.present.obstacles
    return json_response(await service.run_on_site(describe_world, service.site, obstacles))


@router.get(
    "/world/floors/{floor}/mesh/{detail}", operation_id="read_floor_mesh", **_cached_file(GLB)
)
async def read_floor_mesh(
    request: Request, service: Service, _: Viewer, floor: Floor, detail: Detail
) -> Response:
    """Return the solids of a floor as GLB."""
    return await _respond_with_file(
        request, service, GLB, False, lambda: floor_mesh(service.site, floor, detail)
    )


@router.get(
    "/world/floors/{floor}/plan",
    operation_id="read_floor_plan",
    response_model=DescribedFloorPlan,
    responses={304: {"description": "the client has the present plan"}},
)
async def read_floor_plan(request: Request, service: Service, _: Viewer, floor: Floor) -> Response:
    """Return the plan of a floor: outlines from above, by role, without the obstacles."""
    return await _respond_with_file(
        request,
        service,
        JSON,
        False,
        lambda: describe_floor_plan(service.site, floor).model_dump_json().encode(),
    )


@router.get("/world/robot", operation_id="read_robot_mesh", **_cached_file(GLB))
async def read_robot_mesh(request: Request, service: Service, _: Viewer) -> Response:
    """Return the robot with its arm stowed, as GLB."""
    return await _respond_with_file(request, service, GLB, False, lambda: robot_mesh(service.site))


@router.get("/world/checkpoints/{kind}", operation_id="read_checkpoint_mesh", **_cached_file(GLB))
async def read_checkpoint_mesh(
    request: Request, service: Service, _: Viewer, kind: CheckpointKind
) -> Response:
    """Return a checkpoint of a kind as GLB."""
    return await _respond_with_file(request, service, GLB, False, lambda: checkpoint_mesh(kind))


@router.get(
    "/world/floors/{floor}/standing/{heading}", operation_id="read_standing", **_cached_file(MAP)
)
async def read_standing_map(
    request: Request,
    service: Service,
    _: Viewer,
    floor: Floor,
    heading: Annotated[int, Path(ge=0, le=1_000, description="number of the heading")],
) -> Response:
    """Return a map of where on a floor the robot can stand with a heading.

    It states which of these places the robot can reach from the docks. The heading is the number of
    one of equal steps. `docs/service.md` describes the format.
    """
    obstacles = service.obstacles.present.obstacles
    return await _respond_with_file(
        request,
        service,
        MAP,
        True,
        lambda: standing_map(service.site, floor, heading, obstacles).to_bytes(),
    )


@router.get("/world/obstacles", operation_id="list_obstacles", response_model=ObstacleList)
async def list_obstacles(service: Service, _: Viewer) -> Response:
    """Return the obstacles of the site; the ETag is their revision."""
    present = service.obstacles.present
    return json_response(present, revision=present.revision)


@router.put(
    "/world/obstacles",
    operation_id="put_obstacles",
    response_model=ObstacleList,
    responses=problem_responses(412, 428),
)
async def put_obstacles(
    service: Service, _: Planner, given: JsonBody[ObstaclesGiven], made_on: MadeOn
) -> Response:
    """Replace all obstacles of the site; later previews and runs take them into account."""
    obstacles = given.obstacles
    await service.run_on_site(with_obstacles, service.site, obstacles)
    changed = await service.run_on_site(service.obstacles.replace, obstacles, made_on)
    service.rooms.publish_world(changed.revision)
    return json_response(changed, revision=changed.revision)


@router.post("/world/way", operation_id="preview_way", response_model=PreviewedWay)
async def preview_a_path(service: Service, _: Viewer, asked: JsonBody[WayAsked]) -> Response:
    """Return the path that the robot would take, with its time, climb and energy."""
    goal = asked.task or asked.goal
    if goal is None or (asked.task and asked.goal):
        raise Invalid("the end of the path is not clear: give either a `goal` or a `task`")
    obstacles = service.obstacles.present.obstacles
    return json_response(
        await service.run_on_site(preview_path, service.site, asked.start, goal, obstacles)
    )


@router.get(
    "/missions/{id}/preview", operation_id="preview_mission", response_model=PreviewedMission
)
async def preview_a_mission(service: Service, _: Viewer, id: PlanId) -> Response:
    """Return the paths between a mission's tasks, with times, climb and energy.

    The first paths are those if each task succeeds, in their order; those of other transitions
    follow.
    """
    plan = (await open_valid_plan(service, id)).plan
    obstacles = service.obstacles.present.obstacles
    preview = await service.run_on_site(preview_mission, service.site, plan.mission, obstacles)
    return json_response(preview, revision=plan.revision)


async def _respond_with_file(
    request: Request,
    service: PlanningService,
    media: str,
    obstacles: bool,
    make: Callable[[], bytes],
) -> Response:
    """Return a file of the world, or 304 if the client has it.

    Args:
        request: Its header `If-None-Match` may name the file that the client has.
        service: The service with the site and its obstacles.
        media: Media type of the file.
        obstacles: True if the file depends on the obstacles.
        make: Function that makes the file's content; called in the site's thread.
    """
    present = service.obstacles.present.obstacles if obstacles else ()
    tag = f'"{await service.run_on_site(world_digest, service.site, present)}"'
    headers = {"etag": tag, "cache-control": "private, no-cache"}
    if request.headers.get("if-none-match") == tag:
        return Response(status_code=304, headers=headers)
    return Response(await service.run_on_site(make), 200, headers, media)
