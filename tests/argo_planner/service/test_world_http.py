"""World over HTTP: meshes, maps, obstacles and previews of paths."""

import json

import pytest

from argo_env.planning.opening import OpenedSite
from argo_planner.service.world.standing_map import Ground, read_standing_map
from tests.argo_planner.service.served import Served
from tests.argo_planner.service.test_http import problem
from tests.argo_planner.service.test_run_host import SCRIPT
from tests.argo_planner.service.test_runs import start, wait_for


@pytest.fixture(autouse=True)
def without_obstacles(service: Served):
    yield
    assert service.put_obstacles().status_code == 200


def box(x: float, y: float, z: float, edge: float = 0.8) -> dict:
    return {"id": "box", "name": "a box", "pose": {"x": x, "y": y, "z": z}, "size": [edge] * 3}


def test_the_description_meshes_and_maps_agree_with_the_site(
    service: Served, site: OpenedSite
) -> None:
    client = service.client
    world = client.get("/api/world").json()
    assert len(world["floors"]) == len(site.site.spec.floors)
    assert {c["id"] for c in world["checkpoints"]} == {c.id for c in site.site.checkpoints}
    floor = world["floors"][0]["number"]
    for detail in world["details"]:
        mesh = client.get(f"/api/world/floors/{floor}/mesh/{detail}")
        assert mesh.content[:4] == b"glTF"
        assert mesh.headers["content-type"] == "model/gltf-binary"
        known = {"if-none-match": mesh.headers["etag"]}
        again = client.get(f"/api/world/floors/{floor}/mesh/{detail}", headers=known)
        assert (again.status_code, again.content) == (304, b"")
    assert client.get("/api/world/robot").content[:4] == b"glTF"
    for kind in {c["kind"] for c in world["checkpoints"]}:
        assert client.get(f"/api/world/checkpoints/{kind}").content[:4] == b"glTF"
    answer = client.get(f"/api/world/floors/{floor}/standing/0")
    standing = read_standing_map(answer.content)
    dock = world["docks"][0]["pose"]
    number = next(f["number"] for f in world["floors"] if abs(f["z"] - dock["z"]) < 0.1)
    heading = min(
        range(len(world["headings"])), key=lambda k: abs(world["headings"][k] - dock["yaw"])
    )
    there = client.get(f"/api/world/floors/{number}/standing/{heading}").content
    assert read_standing_map(there).ground_at(dock["x"], dock["y"], dock["z"]) is Ground.REACHED
    assert standing.floor == floor
    for path in ("floors/99/mesh/full", "floors/99/standing/0", "floors/1/standing/999"):
        assert client.get(f"/api/world/{path}").status_code in (404, 422)
    problem(client.get("/api/world/floors/1/mesh/none"), 422, "invalid")


def test_obstacles_change_paths_and_are_stored(service: Served) -> None:
    client = service.client
    id = service.imported(SCRIPT, start_area=1)
    preview = client.get(f"/api/missions/{id}/preview").json()
    assert preview["time"] > 0
    assert not preview["problems"]
    way = preview["ways"][1]["way"]
    middle = way["points"][len(way["points"]) // 2]
    page = service.follow(id)
    given = service.put_obstacles(box(*middle[1:4]))
    assert given.status_code == 200, given.text
    while (message := json.loads(page.recv(timeout=30)))["kind"] != "world":
        pass
    assert message["revision"] == given.json()["revision"]
    around = client.get(f"/api/missions/{id}/preview").json()
    assert around["time"] > preview["time"] or around["problems"]
    world = client.get("/api/world").json()
    assert [o["name"] for o in world["obstacles"]] == ["a box"]
    assert json.loads((service.folder / "obstacles.json").read_bytes())["obstacles"]
    problem(service.put_obstacles(revision=1), 412, "stale-revision")
    twice = service.put_obstacles(box(0, 0, 0), box(1, 1, 0))
    assert "two obstacles" in problem(twice, 422, "invalid")["detail"]
    page.close()


@pytest.mark.long
def test_runs_avoid_obstacles(service: Served) -> None:
    client = service.client
    id = service.imported(SCRIPT, start_area=1)
    way = client.get(f"/api/missions/{id}/preview").json()["ways"][1]["way"]
    middle = way["points"][len(way["points"]) // 2]
    service.put_obstacles(box(*middle[1:4], edge=0.4))
    around = client.get(f"/api/missions/{id}/preview").json()
    run = start(service, id, speed=None)["id"]
    ended = wait_for(service, run, status="ended")
    if around["problems"]:
        assert ended["headline"]["word"] != "Success"
    else:
        assert ended["headline"]["word"] == "Success"
        assert ended["t"] == pytest.approx(around["time"], rel=0.05)


def test_a_path_is_previewed(service: Served) -> None:
    client = service.client
    world = client.get("/api/world").json()
    dock = world["docks"][0]["pose"]
    checkpoint = next(c for c in world["checkpoints"] if c["stands"])
    asked = {"start": dock, "goal": checkpoint["stands"]}
    way = client.post("/api/world/way", json=asked).json()
    assert way["time"] > 0
    assert way["problem"] is None
    nowhere = {"start": dock, "goal": {"x": 1e3, "y": 1e3, "z": 0}}
    assert client.post("/api/world/way", json=nowhere).json()["problem"]
    problem(client.post("/api/world/way", json={"start": dock}), 422, "invalid")
    with_text = {"start": dock, "goal": dock | {"x": "1.5"}}
    assert (
        "goal.x" in problem(client.post("/api/world/way", json=with_text), 422, "invalid")["detail"]
    )


def test_the_plan_of_a_floor_shows_its_deck_stairs_and_equipment(service: Served) -> None:
    client = service.client
    plans = {n: client.get(f"/api/world/floors/{n}/plan") for n in (1, 2, 3)}
    roles = {n: [shape["role"] for shape in plan.json()["shapes"]] for n, plan in plans.items()}
    assert {"ground", "stair", "vessel", "dock"} <= {*roles[1]}
    assert "ground" not in roles[2]
    assert plans[2].json()["bounds"] == plans[3].json()["bounds"]
    x0, y0, x1, y1 = plans[2].json()["bounds"]
    for shape in plans[2].json()["shapes"]:
        for corners in shape["outlines"]:
            assert all(x0 <= x <= x1 and y0 <= y <= y1 for x, y in corners)
    known = {"if-none-match": plans[1].headers["etag"]}
    again = client.get("/api/world/floors/1/plan", headers=known)
    assert (again.status_code, again.content) == (304, b"")
    problem(client.get("/api/world/floors/99/plan"), 404, "not-found")
