"""Drafts in the service: uploads with lines that are left, and requests that decide on them."""

import json
from pathlib import Path

import pytest

from argo_compiler.base.errors import Unavailable
from argo_planner.service.drafts import drafts
from argo_planner.service.storage.draft_folder import DraftFolder
from tests.argo_compiler.script.documents_made import pdf_table, workbook
from tests.argo_planner.service.served import SECRETS, AccessRole, Served, served
from tests.argo_planner.service.test_http import problem

SCRIPT = """Start in starting area 1.
I'd like to have valve R25.
Should it check R18 too?
Photograph pump 3.
Check checkpoint 5.
"""


def upload(service: Served, script: str = SCRIPT, **params: str | int) -> dict:
    answer = service.client.post(
        "/api/imports", params={"filename": "round.txt"} | params, content=script
    )
    assert answer.status_code == 202, answer.text
    assert answer.headers["location"] == f"/api/drafts/{answer.json()['id']}"
    return answer.json()


def decide(service: Served, draft: dict, *acts: dict, status: int = 200) -> dict:
    answer = service.post(f"/api/drafts/{draft['id']}/acts", draft["revision"], acts=acts)
    assert answer.status_code == status, answer.text
    return answer.json()


def complete(service: Served, draft: dict) -> dict:
    answer = service.client.post(
        f"/api/drafts/{draft['id']}/mission", headers={"if-match": f'"{draft["revision"]}"'}
    )
    assert answer.status_code == 201, answer.text
    return answer.json()


def states(draft: dict) -> list[str]:
    return [line["state"] for line in draft["lines"]]


def test_an_upload_with_lines_left_becomes_a_mission_when_all_are_decided(service: Served) -> None:
    draft = upload(service)
    assert states(draft) == ["understood", "proposed", "open", "open", "understood"]
    assert (draft["to_confirm"], draft["to_answer"], draft["is_complete"]) == (1, 2, False)
    proposed, asked = draft["lines"][1:3]
    assert proposed["sentences"] == ["Check checkpoint 4."]
    assert asked["choices"][0] == ["Check checkpoint 14."]
    draft = decide(
        service,
        draft,
        {"kind": "confirm", "labels": ["2"]},
        {"kind": "choose", "label": "3", "number": 1},
        {"kind": "say", "label": "4", "sentences": ["Check checkpoint  6."]},
    )
    assert states(draft) == ["understood"] * 5
    assert [line["act"] for line in draft["lines"]] == [None, "confirmed", "chosen", "said", None]
    assert draft["is_complete"]
    assert draft["lines"][4]["steps"] == ["Check checkpoint #5"]
    made = complete(service, draft)
    assert made["name"] == "round"
    objects = [task["object_id"] for task in service.mission(made["id"])["tasks"]]
    assert objects == [None, "4", "14", "6", "5"]
    problem(service.client.get(f"/api/drafts/{draft['id']}"), 404, "not-found")


def test_what_is_left_is_never_a_mission(service: Served) -> None:
    """An incomplete draft can't be planned, nor is it among the missions to run or export."""
    before = len(service.client.get("/api/missions").json()["missions"])
    draft = upload(service)
    at = f"/api/drafts/{draft['id']}/mission"
    refused = problem(service.client.post(at, headers={"if-match": "*"}), 422, "incomplete")
    assert "1 line to confirm and 2 lines to answer" in refused["detail"]
    for path in ("", "/export/json", "/reading"):
        problem(service.client.get(f"/api/missions/{draft['id']}{path}"), 404, "not-found")
    assert len(service.client.get("/api/missions").json()["missions"]) == before


def test_a_script_that_is_understood_whole_has_no_draft(service: Served) -> None:
    answer = service.client.post(
        "/api/imports?filename=a.txt", content="Start in starting area 1.\nCheck checkpoint 5.\n"
    )
    assert answer.status_code == 201


def test_decisions_are_undone_also_in_the_same_request(service: Served) -> None:
    draft = upload(service)
    confirm = {"kind": "confirm", "labels": ["2"]}
    undo = {"kind": "undo", "labels": ["2"]}
    aside = {"kind": "set_aside", "labels": ["2"]}
    assert states(decide(service, draft, confirm, undo))[1] == "proposed"
    draft = decide(service, draft | {"revision": 2}, confirm)
    draft = decide(service, draft, undo, aside)
    assert states(draft)[1] == "set aside"
    draft = decide(service, draft, undo)
    assert draft["lines"][1]["state"] == "proposed"
    assert draft["lines"][1]["act"] is None


def test_a_sentence_that_is_not_understood_is_answered_with_its_message(service: Served) -> None:
    draft = decide(
        service, upload(service), {"kind": "say", "label": "4", "sentences": ["Chek the zorg."]}
    )
    line = draft["lines"][3]
    assert (line["state"], line["act"], line["sentences"]) == ("open", "said", ["Chek the zorg."])
    assert "does not understand" in line["reason"]


@pytest.mark.parametrize(
    ("act", "message"),
    [
        ({"kind": "confirm", "labels": ["99"]}, "has no line 99"),
        ({"kind": "confirm", "labels": ["3"]}, "line 3 of round.txt is open"),
        ({"kind": "choose", "label": "2", "number": 1}, "line 2"),
        ({"kind": "choose", "label": "3", "number": 9}, "has 3 choices"),
        ({"kind": "say", "label": "3", "sentences": ["  "]}, "is empty"),
        ({"kind": "say", "label": "3", "sentences": ["x" * 1001]}, "at most 1000 characters"),
        ({"kind": "set_aside", "labels": []}, "at least 1 item"),
        ({"kind": "set_aside", "labels": ["../x"]}, "should match pattern"),
    ],
)
def test_impossible_acts_are_refused_and_change_nothing(service, act, message) -> None:
    draft = upload(service)
    refused = decide(service, draft, {"kind": "confirm"}, act, status=422)
    assert message in refused["detail"]
    assert service.client.get(f"/api/drafts/{draft['id']}").json() == draft


def test_a_decision_on_an_older_state_is_refused(service: Served) -> None:
    draft = upload(service)
    decide(service, draft, {"kind": "confirm"})
    refused = decide(service, draft, {"kind": "set_aside", "labels": ["3"]}, status=412)
    assert (refused["code"], refused["newest"]) == ("stale-revision", 2)
    answer = service.post(f"/api/drafts/{draft['id']}/acts", acts=[{"kind": "confirm"}])
    problem(answer, 428, "revision-missing")


def test_areas_that_a_script_leaves_open_are_chosen(service: Served) -> None:
    draft = upload(service, "Start: area 1 or 2\nI'd like to have valve R25.\n")
    assert draft["areas_to_choose"] == ["start"]
    draft = decide(service, draft, {"kind": "confirm"})
    assert (draft["to_confirm"], draft["is_complete"]) == (0, False)
    refused = service.post(f"/api/drafts/{draft['id']}/mission", "*")
    assert "leaves the start open" in problem(refused, 422, "invalid")["diagnostics"][0]["message"]
    draft = decide(service, draft, {"kind": "areas", "start_area": 2})
    assert draft["is_complete"]
    assert service.mission(complete(service, draft)["id"])["start_area"] == 2


def test_only_planners_decide(service: Served) -> None:
    draft = upload(service)
    viewer = service.as_("", SECRETS[AccessRole.VIEW])
    at = f"/api/drafts/{draft['id']}"
    assert viewer.get(at).json() == draft
    body = {"acts": [{"kind": "confirm"}]}
    problem(viewer.post(f"{at}/acts", json=body, headers={"if-match": "*"}), 403, "access-denied")
    problem(viewer.post(f"{at}/mission", headers={"if-match": "*"}), 403, "access-denied")
    problem(viewer.delete(at), 403, "access-denied")


def test_drafts_are_listed_and_deleted(service: Served) -> None:
    draft = upload(service)
    listed = service.client.get("/api/drafts").json()["drafts"]
    assert listed[0]["id"] == draft["id"]
    assert (listed[0]["to_confirm"], listed[0]["to_answer"]) == (1, 2)
    assert service.client.delete(f"/api/drafts/{draft['id']}").status_code == 204
    assert draft["id"] not in [
        one["id"] for one in service.client.get("/api/drafts").json()["drafts"]
    ]
    problem(service.client.delete(f"/api/drafts/{draft['id']}"), 404, "not-found")


def test_drafts_are_limited_in_number_and_length(service: Served, monkeypatch) -> None:
    monkeypatch.setattr(drafts, "MOST_LINES", 3)
    answer = service.client.post("/api/imports?filename=long.txt", content=SCRIPT)
    assert "more than 3 lines" in problem(answer, 422, "invalid")["detail"]
    monkeypatch.undo()
    monkeypatch.setattr(drafts, "MOST_DRAFTS", 0)
    answer = service.client.post("/api/imports?filename=one.txt", content=SCRIPT)
    problem(answer, 409, "conflict")


@pytest.mark.long
def test_decisions_survive_a_restart(tmp_path: Path, site) -> None:
    with served(tmp_path, site) as service:
        draft = decide(service, upload(service), {"kind": "confirm"})
    with served(tmp_path, site) as service:
        assert service.client.get(f"/api/drafts/{draft['id']}").json() == draft
        assert service.client.get("/api/drafts").json()["drafts"][0]["to_confirm"] == 0


def test_a_damaged_draft_is_named_and_left_out_of_the_list(tmp_path: Path, site, caplog) -> None:
    id = "0123456789ab"
    folder = tmp_path / "drafts"
    folder.mkdir()
    (folder / f"{id}.json").write_text('{"id": 3}', encoding="utf-8")
    with served(tmp_path, site) as service:
        assert service.client.get("/api/drafts").json() == {"drafts": []}
        assert f"{id}.json is damaged" in caplog.text
        refused = problem(service.client.get(f"/api/drafts/{id}"), 503, "unavailable")
        assert "import the script again" in refused["detail"]


def test_a_copied_draft_is_refused(tmp_path: Path, service: Served) -> None:
    id = upload(service)["id"]
    stored = json.loads((service.folder / "drafts" / f"{id}.json").read_bytes())
    assert stored["text"] == SCRIPT
    del stored["checksum"]
    other = "0123456789ab"
    (tmp_path / f"{other}.json").write_text(json.dumps(stored), encoding="utf-8")
    with pytest.raises(Unavailable, match="was copied or renamed"):
        DraftFolder(tmp_path, lambda: other).load(other)


def test_the_imported_script_is_that_of_the_present_mission(service: Served) -> None:
    """It has the places of the tasks, until the mission is replaced or its import is undone."""
    draft = decide(
        service, upload(service), {"kind": "confirm"}, {"kind": "set_aside", "labels": ["3", "4"]}
    )
    id = complete(service, draft)["id"]
    at = f"/api/missions/{id}/imported-script"
    assert service.client.get(at).json() == {"revision": 1, "text": SCRIPT}
    rename = {"kind": "rename_task", "name": "MEASURE 5", "new_name": "last"}
    assert service.command(id, 1, rename).status_code == 200
    assert service.client.get(at).json()["text"] == SCRIPT
    new = "Start in starting area 1.\nCheck checkpoint 7.\n"
    body = {"id": "w", "script": new}
    headers = {"if-match": '"2"'}
    written = service.client.put(f"/api/missions/{id}/script", json=body, headers=headers)
    assert written.status_code == 200, written.text
    assert service.client.get(at).json() == {"revision": 3, "text": new}
    assert service.command(id, 3, kind="undo").status_code == 200
    assert service.client.get(at).json() == {"revision": 0, "text": ""}
    problem(service.client.get(f"/api/missions/{'0' * 12}/imported-script"), 404, "not-found")


ROWS = [
    ["CP", "Instrument", "Floor", "Normal", "Unit", "Reading", "Remarks"],
    ["1", "Pressure gauge 1", "1", "3 - 5", "bar", "", ""],
    ["5", "Valve R12", "2", "closed", "", "", "behind the pump"],
    ["", "Photograph the pump", "", "", "", "", ""],
    ["", "Handrails secure", "", "", "", "", ""],
]


def upload_file(service: Served, name: str, content: bytes) -> dict:
    answer = service.client.post("/api/imports", params={"filename": name}, content=content)
    assert answer.status_code == 202, answer.text
    return answer.json()


@pytest.mark.parametrize(
    ("name", "content", "place"),
    [
        ("round.xlsx", lambda: workbook(ROWS), "A3:G3"),
        ("round.pdf", lambda: pdf_table(ROWS), "page 1, row 2"),
        ("round.csv", lambda: "\n".join(map(",".join, ROWS)).encode(), "line 3"),
    ],
)
def test_a_document_is_decided_on_line_by_line(service: Served, name, content, place) -> None:
    """Its lines have their places, and a message about an open line stands at that line only."""
    draft = upload_file(service, name, content())
    asked = next(line for line in draft["lines"] if line["place"] == place)
    assert asked["choices"][1] == ["Check checkpoint 5."]
    assert not [one for one in draft["diagnostics"] if one["severity"] == "error" and one["span"]]
    others = [line["label"] for line in draft["lines"] if line["names_nothing"]]
    assert len(others) == 2
    acts = [{"kind": "choose", "label": asked["label"], "number": 2}]
    acts += [{"kind": "set_aside", "labels": others}, {"kind": "areas", "start_area": 1}]
    draft = decide(service, draft, *acts)
    assert draft["is_complete"]
    mission = complete(service, draft)
    text = service.client.get(f"/api/missions/{mission['id']}/imported-script").json()["text"]
    tasks = service.mission(mission["id"])["tasks"]
    sources = [task["source"]["line"] for task in tasks if task["source"]]
    assert "Pressure gauge 1" in text.splitlines()[sources[0] - 1]
    assert "Valve R12" in text.splitlines()[sources[1] - 1]


def test_a_document_is_decided_on_after_a_restart(tmp_path: Path, site) -> None:
    with served(tmp_path, site) as service:
        draft = upload_file(service, "round.xlsx", workbook(ROWS))
    with served(tmp_path, site) as service:
        again = service.client.get(f"/api/drafts/{draft['id']}").json()
        assert again == draft
        places = [line["place"] for line in again["lines"]]
        draft = decide(
            service, again, {"kind": "set_aside", "labels": [again["lines"][-1]["label"]]}
        )
        assert [line["place"] for line in draft["lines"]] == places
