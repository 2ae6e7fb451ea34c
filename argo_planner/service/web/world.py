"""The world: floors, checkpoints, where the robot can stand, obstacles, and ways before they are
driven."""

from collections.abc import Callable
from typing import Annotated, Any

from fastapi import Path, Request, Response
from pydantic import Field

from argo_compiler.base.catalog import CheckpointKind
from argo_compiler.base.errors import Invalid
from argo_compiler.base.model import Model, Pose
from argo_compiler.il import Task
from argo_planner.service.web.bodies import Sent
from argo_planner.service.web.missions import sound_plan
from argo_planner.service.web.problems import documented
from argo_planner.service.web.requests import (
    MadeOn,
    PlanId,
    Planner,
    PlanningService,
    Service,
    Viewer,
    answers_file,
    routes,
    said,
)
from argo_planner.service.world.description import WorldDescription, describe, world_digest
from argo_planner.service.world.kept import ObstacleList
from argo_planner.service.world.meshes import Detail, checkpoint_mesh, floor_mesh, robot_mesh
from argo_planner.service.world.obstacles import MOST_OBSTACLES, Obstacle, with_obstacles
from argo_planner.service.world.previews import (
    PreviewedMission,
    PreviewedWay,
    preview_mission,
    preview_way,
)
from argo_planner.service.world.standing import standing_map

GLB = "model/gltf-binary"
MAP = "application/octet-stream"

router = routes("world")

Floor = Annotated[int, Path(ge=-1_000, le=1_000, description="number of the floor")]


class ObstaclesGiven(Model):
    """All obstacles that are to stand on the site."""

    obstacles: tuple[Obstacle, ...] = Field(max_length=MOST_OBSTACLES)


class WayAsked(Model):
    """A way: to a pose, or to a task's place with its action."""

    start: Pose
    goal: Pose | None = None
    task: Task | None = None


def _file(media: str) -> dict[str, Any]:
    told = answers_file("the file", media)
    told["responses"][304] = {"description": "as the client has it"}
    return told


@router.get("/world", operation_id="read_world", response_model=WorldDescription)
async def read_world(service: Service, _: Viewer) -> Response:
    """The site: floors, checkpoints, docks, places, the robot, and the obstacles on it."""
    obstacles = service.obstacles.present.obstacles
    return said(await service.on_site(describe, service.site, obstacles))


@router.get("/world/floors/{floor}/mesh/{detail}", operation_id="read_floor_mesh", **_file(GLB))
async def read_floor_mesh(
    request: Request, service: Service, _: Viewer, floor: Floor, detail: Detail
) -> Response:
    """The solids of a floor as GLB."""
    return await _kept(
        request, service, GLB, False, lambda: floor_mesh(service.site, floor, detail)
    )


@router.get("/world/robot", operation_id="read_robot_mesh", **_file(GLB))
async def read_robot_mesh(request: Request, service: Service, _: Viewer) -> Response:
    """The robot as GLB, its arm stowed."""
    return await _kept(request, service, GLB, False, lambda: robot_mesh(service.site))


@router.get("/world/checkpoints/{kind}", operation_id="read_checkpoint_mesh", **_file(GLB))
async def read_checkpoint_mesh(
    request: Request, service: Service, _: Viewer, kind: CheckpointKind
) -> Response:
    """A checkpoint of a kind as GLB."""
    return await _kept(request, service, GLB, False, lambda: checkpoint_mesh(kind))


@router.get("/world/floors/{floor}/standing/{heading}", operation_id="read_standing", **_file(MAP))
async def read_standing(
    request: Request,
    service: Service,
    _: Viewer,
    floor: Floor,
    heading: Annotated[int, Path(ge=0, le=1_000, description="number of the heading")],
) -> Response:
    """Where on a floor the robot can stand with a heading, and get to; the format is in the
    documentation of the service."""
    obstacles = service.obstacles.present.obstacles
    return await _kept(
        request,
        service,
        MAP,
        True,
        lambda: standing_map(service.site, floor, heading, obstacles).to_bytes(),
    )


@router.get("/world/obstacles", operation_id="list_obstacles", response_model=ObstacleList)
async def list_obstacles(service: Service, _: Viewer) -> Response:
    """The obstacles on the site; their ETag is how often they have changed."""
    present = service.obstacles.present
    return said(present, revision=present.revision)


@router.put(
    "/world/obstacles",
    operation_id="put_obstacles",
    response_model=ObstacleList,
    responses=documented(412, 428),
)
async def put_obstacles(
    service: Service, _: Planner, given: Sent[ObstaclesGiven], made_on: MadeOn
) -> Response:
    """Puts these obstacles in the place of all that there are. Plans and runs go round them."""
    obstacles = given.obstacles
    await service.on_site(with_obstacles, service.site, obstacles)
    changed = await service.on_site(service.obstacles.replace, obstacles, made_on)
    service.rooms.publish_world(changed.revision)
    return said(changed, revision=changed.revision)


@router.post("/world/way", operation_id="preview_way", response_model=PreviewedWay)
async def preview_a_way(service: Service, _: Viewer, asked: Sent[WayAsked]) -> Response:
    """The way that the robot would take, with its time, climb and energy."""
    goal = asked.task or asked.goal
    if goal is None or (asked.task and asked.goal):
        raise Invalid("say where the way leads: give either a `goal` or a `task`")
    obstacles = service.obstacles.present.obstacles
    return said(await service.on_site(preview_way, service.site, asked.start, goal, obstacles))


@router.get(
    "/missions/{id}/preview", operation_id="preview_mission", response_model=PreviewedMission
)
async def preview_a_mission(service: Service, _: Viewer, id: PlanId) -> Response:
    """The ways of a mission as they will be driven, with times, climb and energy."""
    plan = (await sound_plan(service, id)).plan
    obstacles = service.obstacles.present.obstacles
    found = await service.on_site(preview_mission, service.site, plan.mission, obstacles)
    return said(found, revision=plan.revision)


async def _kept(
    request: Request,
    service: PlanningService,
    media: str,
    obstacles: bool,
    make: Callable[[], bytes],
) -> Response:
    """A file of the world, which the client keeps as long as the world stays the same."""
    standing = service.obstacles.present.obstacles if obstacles else ()
    tag = f'"{await service.on_site(world_digest, service.site, standing)}"'
    headers = {"etag": tag, "cache-control": "private, no-cache"}
    if request.headers.get("if-none-match") == tag:
        return Response(status_code=304, headers=headers)
    return Response(await service.on_site(make), 200, headers, media)
