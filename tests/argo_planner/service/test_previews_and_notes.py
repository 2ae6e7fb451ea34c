"""Previews of suggested orders, notes of imports, and pictures of readings."""

import pytest

from tests.argo_planner.service.served import Served
from tests.argo_planner.service.test_http import problem
from tests.argo_planner.service.test_jobs import import_script, start_search, wait_for_end
from tests.argo_planner.service.test_runs import start, wait_for

NEAR = (
    "Mission Protocol #1\n1. Set the starting point in starting area 1.\n"
    "2. Check pressure gauge 1.\n"
)


def test_a_suggested_order_has_a_preview(service: Served) -> None:
    id = import_script(service)
    job = start_search(service, id)
    found = wait_for_end(service, job)["found"]
    preview = service.client.get(f"/api/jobs/{job}/preview").json()
    order = [task["name"] for task in found["mission"]["tasks"] if task["action"] != "START"]
    driven = [way["target"] for way in preview["ways"] if way["kind"] == "default"]
    assert driven == order
    assert preview["time"] <= service.client.get(f"/api/missions/{id}/preview").json()["time"]
    problem(service.client.get(f"/api/jobs/{'0' * 12}/preview"), 404, "not-found")


def test_notes_of_an_import_stay_until_the_mission_is_destroyed(service: Served) -> None:
    client = service.client
    id = service.imported(NEAR.replace("Check", "Chek"), start_area=1)
    notes = client.get(f"/api/missions/{id}/notes").json()
    assert notes["revision"] == 1
    assert notes["notes"]
    assert all(note["severity"] != "error" for note in notes["notes"])
    plain = client.get(f"/api/missions/{id}/reading").json()["text"]
    written = client.put(
        f"/api/missions/{id}/script",
        json={"id": "w", "script": plain},
        headers={"if-match": '"1"'},
    )
    assert written.status_code == 200, written.text
    assert client.get(f"/api/missions/{id}/notes").json()["revision"] == 2
    client.delete(f"/api/missions/{id}")
    problem(client.get(f"/api/missions/{id}/notes"), 404, "not-found")
    client.delete(f"/api/bin/{id}")
    assert not (service.folder / "notes" / f"{id}.json").exists()
    other = service.create()
    assert client.get(f"/api/missions/{other}/notes").json() == {"revision": 0, "notes": []}


@pytest.mark.long
def test_a_reading_of_the_camera_has_its_picture(service: Served) -> None:
    pytest.importorskip("cv2")
    id = service.imported(NEAR, start_area=1, end_area=1)
    run = start(service, id, drive="kinematic", sensor="camera", speed=None)["id"]
    (reading,) = wait_for(service, run, status="ended")["readings"]
    at = f"/api/runs/{run}/pictures/{reading['checkpoint']}"
    picture = service.client.get(f"{at}/{round(1000 * reading['t'])}")
    assert picture.headers["content-type"] == "image/png"
    assert picture.content[:8] == b"\x89PNG\r\n\x1a\n"
    problem(service.client.get(f"{at}/1"), 404, "not-found")
    problem(service.client.get("/api/runs/20200101-000000-0000/pictures/1/1"), 404, "not-found")
