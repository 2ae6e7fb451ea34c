"""A mission as it changes: who joins late, comes back, or is too slow ends with the same state."""

import json
from typing import Any

import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus

from argo_compiler.il import Mission
from argo_planner.service.core.commands import Revision
from tests.argo_planner.service.served import Served
from tests.argo_planner.service.test_http import data
from tests.argo_planner.service.test_plan import Follower


class Listener:
    """Knows of a mission what it was told, from a snapshot on."""

    revision: int | None = None
    follower: Follower | None = None

    def told_that(self, message: dict[str, Any]) -> None:
        if message["kind"] == "snapshot":
            state = message["state"]
            assert state["revision"] >= (self.revision or 0), "what was told is not so any more"
            self.follower = Follower(Mission.model_validate(state["mission"]))
            self.revision = state["revision"]
        elif message["kind"] == "revision":
            revision = Revision.model_validate(message["revision"])
            assert revision.number == (self.revision or 0) + 1
            assert self.follower is not None
            self.follower.apply(revision)
            self.revision = revision.number


class Page(Listener):
    """Follows a mission as a page would."""

    def __init__(self, service: Served, id: str, author: str = "ann") -> None:
        self.service, self.id, self.author = service, id, author
        self.members: list[dict[str, Any]] = []
        self.told: list[str] = []
        self.connect()

    def connect(self) -> None:
        self.socket = self.service.follow(self.id, self.author, self.revision)

    def hear(self, until: int) -> None:
        """Hears until it knows a revision."""
        while (self.revision or 0) < until:
            message = json.loads(self.socket.recv(timeout=30))
            self.told.append(message["kind"])
            self.told_that(message)
            self.members = message.get("members", self.members)

    def hear_of(self, kind: str) -> dict[str, Any]:
        """The next message of a kind."""
        while True:
            message: dict[str, Any] = json.loads(self.socket.recv(timeout=30))
            if message["kind"] == kind:
                return message


def rename(service: Served, id: str, revision: int, old: str, new: str) -> None:
    edit = {"kind": "rename_task", "name": old, "new_name": new}
    assert service.command(id, revision, edit).status_code == 200


def test_all_see_the_same(service: Served) -> None:
    id = service.create(mission=data("a", "b", "c"))
    pages = [Page(service, id, author) for author in ("ann", "bob", "cid")]
    for k in range(1, 6):
        rename(service, id, k, "a" if k == 1 else f"a{k - 1}", f"a{k}")
    pages.append(Page(service, id, "dan"))
    for page in pages:
        page.hear(6)
        assert page.follower is not None
        assert page.follower.state == service.mission(id)
        page.socket.close()
    assert pages[3].told == ["snapshot"]


def test_who_comes_back_hears_what_was_missed(service: Served) -> None:
    id = service.create(mission=data("a", "b", "c"))
    page = Page(service, id)
    page.hear(1)
    page.socket.close()
    rename(service, id, 1, "a", "A")
    rename(service, id, 2, "b", "B")
    page.connect()
    page.hear(3)
    assert "snapshot" not in page.told[1:]
    assert page.told.count("revision") == 2
    assert page.follower is not None
    assert page.follower.state == service.mission(id)
    page.socket.close()
    page.revision = 99  # that is not known
    page.connect()
    assert json.loads(page.socket.recv())["kind"] == "snapshot"
    page.socket.close()


def test_who_is_there_and_what_they_have_selected(service: Served) -> None:
    id = service.create(mission=data("a", "b"))
    ann, bob = Page(service, id, "ann"), None
    ann.hear(1)
    bob = Page(service, id, "bob")
    bob.hear(1)
    assert [member["author"] for member in bob.members] == ["ann", "bob"]
    joined = ann.hear_of("members")
    assert [member["author"] for member in joined["members"]] == ["ann", "bob"]
    bob.socket.send(json.dumps({"kind": "select", "names": ["b"]}))
    selected = ann.hear_of("members")["members"]
    assert [member["selection"] for member in selected] == [[], ["b"]]
    bob.socket.close()
    assert [member["author"] for member in ann.hear_of("members")["members"]] == ["ann"]
    ann.socket.close()


def test_names_and_versions_are_told_and_the_end(service: Served) -> None:
    id = service.create(mission=data("a", "b"))
    page = Page(service, id)
    page.hear(1)
    service.client.put(f"/api/missions/{id}/name", json={"name": "Tour"})
    assert page.hear_of("name")["name"] == "Tour"
    service.post(f"/api/missions/{id}/versions", "*", name="v")
    assert [v["name"] for v in page.hear_of("versions")["versions"]] == ["v"]
    service.client.delete(f"/api/missions/{id}")
    assert page.hear_of("deleted")
    with pytest.raises(ConnectionClosed):
        page.socket.recv(timeout=30)
    assert page.socket.close_code == 4404
    with pytest.raises(InvalidStatus, match="404"):
        service.follow(id)
