"""Missions and commands over HTTP."""

import io
import json
import zipfile

import httpx
import pytest

from argo_compiler.il import Mission
from tests.argo_planner.service.served import SECRETS, Served
from tests.argo_planner.service.test_plan import mission

SCRIPT = "Mission Protocol #1\n1. Set the starting point in starting area 1.\n2. Check valve R18.\n"


def data(*names: str) -> dict:
    return mission(*names).model_dump(mode="json")


def problem(answer: httpx.Response, status: int, code: str) -> dict:
    assert answer.status_code == status, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    assert answer.json()["code"] == code, answer.text
    assert answer.json()["detail"]
    return answer.json()


def new_resource(answer: httpx.Response, status: int, address: str) -> dict:
    """Check an answer that something was created, with its id, at an address; return its body."""
    assert answer.status_code == status, answer.text
    assert answer.headers["location"] == f"{address}/{answer.json()['id']}"
    return answer.json()


def test_a_mission_is_created_renamed_copied_deleted_and_restored(service: Served) -> None:
    client = service.client
    id = new_resource(client.post("/api/missions", json={"name": "Round"}), 201, "/api/missions")[
        "id"
    ]
    read = client.get(f"/api/missions/{id}")
    assert read.headers["etag"] == '"1"'
    assert read.json()["mission"]["tasks"] == []
    assert client.put(f"/api/missions/{id}/name", json={"name": "Tour"}).json()["name"] == "Tour"
    copy = client.post(f"/api/missions/{id}/duplicate", json={"name": "Copy"}).json()["id"]
    listed = {m["id"]: m["name"] for m in client.get("/api/missions").json()["missions"]}
    assert (listed[id], listed[copy]) == ("Tour", "Copy")
    assert client.delete(f"/api/missions/{id}").status_code == 204
    problem(client.get(f"/api/missions/{id}"), 404, "not-found")
    assert id in {m["id"] for m in client.get("/api/bin").json()["missions"]}
    back = client.post(f"/api/bin/{id}/restore")
    assert (back.status_code, back.json()["name"]) == (200, "Tour")
    assert client.delete(f"/api/missions/{id}").status_code == 204
    assert client.delete(f"/api/bin/{id}").status_code == 204
    problem(client.post(f"/api/bin/{id}/restore"), 404, "not-found")


def test_a_script_becomes_a_mission_and_is_read_back(service: Served) -> None:
    client = service.client
    made = client.post(
        "/api/imports", params={"filename": "first.txt", "end_area": 2}, content=SCRIPT
    )
    assert made.status_code == 201, made.text
    assert made.json()["name"] == "first"
    at = made.headers["location"]
    reading = client.get(f"{at}/reading").json()
    assert "R18" in reading["text"]
    as_script = client.get(f"{at}/export/script")
    assert "first.txt" in as_script.headers["content-disposition"]
    again = client.post("/api/imports", params={"filename": "again.txt"}, content=as_script.content)
    both = [client.get(made.headers["location"]).json()["mission"] for made in (made, again)]
    assert [t["name"] for t in both[0]["tasks"]] == [t["name"] for t in both[1]["tasks"]]
    unknown = client.post("/api/imports", params={"filename": "x.txt"}, content="Check valve R99")
    assert unknown.status_code == 202
    assert "no valve R99" in unknown.json()["lines"][0]["reason"]


@pytest.mark.parametrize(
    ("format", "ending"),
    [
        ("json", ".json"), ("script", ".txt"), ("scxml", ".scxml"), ("dot", ".dot"),
        ("mermaid", ".mmd"), ("btcpp", ".xml"), ("flexbe", ".zip"), ("isar", ".json"),
        ("ros1-bag", ".bag"),
    ],
)  # fmt: skip
def test_a_mission_is_exported(service: Served, format: str, ending: str) -> None:
    id = service.imported(SCRIPT, end_area=2)
    answer = service.client.get(f"/api/missions/{id}/export/{format}")
    assert answer.status_code == 200, answer.text
    assert answer.content
    assert answer.headers["content-disposition"].endswith(ending)
    if format == "json":
        Mission.model_validate_json(answer.content)
    if answer.headers["content-type"] == "application/zip":
        assert zipfile.ZipFile(io.BytesIO(answer.content)).namelist()


def test_a_command_makes_a_revision(service: Served) -> None:
    id = service.create(mission=data("a", "b", "c"))
    done = service.command(id, 1, {"kind": "remove_task", "name": "b"})
    assert done.status_code == 200, done.text
    assert done.headers["etag"] == '"2"'
    revision = done.json()["revision"]
    assert (revision["number"], revision["author"]) == (2, "ann")
    assert revision["change"]["tasks"]["gone"] == ["b"]
    assert revision["consequences"][0]["message"] == "task 'a' leads to 'c' now, not to 'b'"
    state = service.client.get(f"/api/missions/{id}").json()
    assert [task["name"] for task in state["mission"]["tasks"]] == ["a", "c"]
    assert state["undoable"] == [2]
    undone = service.command(id, 2, kind="undo")
    assert undone.json()["revision"]["reverts"] == 2
    redone = service.command(id, 3, kind="redo")
    assert redone.json()["revision"]["reverts"] == 3
    since = service.client.get(f"/api/missions/{id}/revisions", params={"since": 2}).json()
    assert [r["kind"] for r in since["revisions"]] == ["undo", "redo"]
    problem(service.client.get(f"/api/missions/{id}/revisions?since=99"), 404, "not-found")


def test_commands_must_state_the_revision_that_they_were_made_on(service: Served) -> None:
    id = service.create(mission=data("a", "b", "c"))
    body = {"kind": "edit", "id": "x", "edits": [{"kind": "remove_task", "name": "b"}]}
    url = f"/api/missions/{id}/commands"
    problem(service.client.post(url, json=body), 428, "revision-missing")
    problem(service.client.post(url, json=body, headers={"if-match": "2"}), 422, "invalid")
    service.command(id, 1, {"kind": "rename_task", "name": "a", "new_name": "A"})
    stale = service.client.post(url, json=body, headers={"if-match": '"1"'})
    error = problem(stale, 412, "stale-revision")
    assert error["newest"] == 2
    assert [r["edits"][0]["new_name"] for r in error["since"]] == ["A"]
    done = service.client.post(url, json=body, headers={"if-match": "*"})
    assert done.json()["revision"]["number"] == 3
    again = service.client.post(url, json=body, headers={"if-match": '"1"'})
    assert again.json()["revision"] == done.json()["revision"]
    body["edits"] = [{"kind": "remove_task", "name": "c"}]
    taken = service.client.post(url, json=body, headers={"if-match": "*"})
    problem(taken, 409, "command-id-taken")


def test_a_refused_command_changes_nothing(service: Served) -> None:
    id = service.create(mission=data("a", "b", "c"))
    refused = service.command(
        id, 1, {"kind": "remove_task", "name": "a"}, {"kind": "remove_task", "name": "nobody"}
    )
    error = problem(refused, 409, "edit-refused")
    assert error["place"] == 1
    assert error["diagnostics"][0]["code"] == "edit.unknown-task"
    wrong = service.command(id, 1, {"kind": "remove_task"})
    assert "name" in problem(wrong, 422, "invalid")["detail"]
    assert service.client.get(f"/api/missions/{id}").headers["etag"] == '"1"'
    bob = service.as_("bob")
    service.command(id, 1, {"kind": "change_task", "name": "a", "velocity": 0.2})
    service.command(id, 2, {"kind": "change_task", "name": "a", "velocity": 0.3}, client=bob)
    error = problem(service.command(id, 3, kind="undo"), 409, "changed-since")
    assert "changed later, by bob in revision 3" in error["detail"]


def test_versions_are_stored_and_restored(service: Served) -> None:
    client = service.client
    id = service.create(mission=data("a", "b"))
    at = f"/api/missions/{id}/versions"
    made = client.post(at, json={"name": "é/1 ?"}, headers={"if-match": '"1"'})
    assert (made.status_code, made.headers["location"]) == (201, f"{at}/1")
    service.command(id, 1, {"kind": "remove_task", "name": "a"})
    stale = client.post(at, json={"name": "2"}, headers={"if-match": '"1"'})
    problem(stale, 412, "stale-revision")
    taken = client.post(at, json={"name": "é/1 ?"}, headers={"if-match": "*"})
    problem(taken, 409, "conflict")
    assert [v["name"] for v in client.get(at).json()["versions"]] == ["é/1 ?"]
    assert len(client.get(f"{at}/1").json()["mission"]["tasks"]) == 2
    unknown = client.post(f"{at}/2/restore", json={"id": "r"}, headers={"if-match": "*"})
    problem(unknown, 404, "not-found")
    restored = client.post(f"{at}/1/restore", json={"id": "r"}, headers={"if-match": '"2"'})
    assert restored.json()["revision"]["about"] == "version é/1 ?"
    assert [task["name"] for task in service.mission(id)["tasks"]] == ["a", "b"]
    assert client.delete(f"{at}/1").status_code == 204
    problem(client.get(f"{at}/1"), 404, "not-found")


def test_a_script_replaces_a_mission_and_is_undone(service: Served) -> None:
    id = service.create(mission=data("a", "b"))
    text = SCRIPT + "3. Return to the docking station in starting area 2.\n"
    written = service.client.put(
        f"/api/missions/{id}/script", json={"id": "s", "script": text}, headers={"if-match": '"1"'}
    )
    assert written.status_code == 200, written.text
    assert written.json()["revision"]["about"] == "a script"
    assert service.command(id, 2, kind="undo").status_code == 200
    assert [task["name"] for task in service.mission(id)["tasks"]] == ["a", "b"]


def test_an_unknown_format_is_refused_with_a_similar_one(service: Served) -> None:
    id = service.imported(SCRIPT, end_area=2)
    refused = service.client.get(f"/api/missions/{id}/export/ros1")
    assert (
        problem(refused, 404, "not-found")["detail"] == "no format `ros1`; did you mean `ros1-bag`?"
    )


def test_each_role_has_its_rights(service: Served) -> None:
    id = service.create(mission=data("a", "b"))
    by_role = {role: service.as_("x", secret) for role, secret in SECRETS.items()}
    assert by_role["view"].get("/api/service").json() | {"argo": ""} == {
        "argo": "", "site": "umad", "author": "view", "named": True, "role": "view",
        "extensions": [],
    }  # fmt: skip
    edit = {"kind": "rename_task", "name": "a", "new_name": "A"}
    problem(service.command(id, 1, edit, client=by_role["view"]), 403, "access-denied")
    problem(by_role["view"].post("/api/missions", json={"name": "x"}), 403, "access-denied")
    assert service.command(id, 1, edit, client=by_role["plan"]).status_code == 200
    assert by_role["view"].get(f"/api/missions/{id}").json()["revision"] == 2


def test_an_imported_mission_is_analysed(service: Served) -> None:
    id = service.imported(SCRIPT, end_area=2)
    with service.follow(id) as socket:
        for message in socket:
            received = json.loads(message)
            if received["kind"] == "analysis":
                break
    assert received["analysis"]["revision"] == 1
    assert received["analysis"]["analysis"]["duration"]["least"]["value"] > 0
    read = service.client.get(f"/api/missions/{id}/analysis").json()
    assert read == received["analysis"]
