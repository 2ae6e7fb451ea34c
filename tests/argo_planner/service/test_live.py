"""Event feed of a mission: clients that join late or reconnect reach the same state."""

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
    """Copy of a mission that is built from the messages of its event feed."""

    revision: int | None = None
    follower: Follower | None = None

    def apply_message(self, message: dict[str, Any]) -> None:
        if message["kind"] == "snapshot":
            state = message["state"]
            assert state["revision"] >= (self.revision or 0), (
                "the snapshot is older than the known state"
            )
            self.follower = Follower(Mission.model_validate(state["mission"]))
            self.revision = state["revision"]
        elif message["kind"] == "revision":
            revision = Revision.model_validate(message["revision"])
            assert revision.number == (self.revision or 0) + 1
            assert self.follower is not None
            self.follower.apply(revision)
            self.revision = revision.number


class Page(Listener):
    """Client that follows a mission as a page does."""

    def __init__(self, service: Served, id: str, author: str = "ann") -> None:
        self.service, self.id, self.author = service, id, author
        self.members: list[dict[str, Any]] = []
        self.kinds: list[str] = []
        self.connect()

    def connect(self) -> None:
        self.socket = self.service.follow(self.id, self.author, self.revision)

    def receive_until(self, revision: int) -> None:
        """Receive messages until a revision is known."""
        while (self.revision or 0) < revision:
            message = json.loads(self.socket.recv(timeout=30))
            self.kinds.append(message["kind"])
            self.apply_message(message)
            self.members = message.get("members", self.members)

    def receive_kind(self, kind: str) -> dict[str, Any]:
        """Return the next message of a kind."""
        while True:
            message: dict[str, Any] = json.loads(self.socket.recv(timeout=30))
            if message["kind"] == kind:
                return message


def rename(service: Served, id: str, revision: int, old: str, new: str) -> None:
    edit = {"kind": "rename_task", "name": old, "new_name": new}
    assert service.command(id, revision, edit).status_code == 200


def test_all_clients_have_the_same_state(service: Served) -> None:
    id = service.create(mission=data("a", "b", "c"))
    pages = [Page(service, id, author) for author in ("ann", "bob", "cid")]
    for k in range(1, 6):
        rename(service, id, k, "a" if k == 1 else f"a{k - 1}", f"a{k}")
    pages.append(Page(service, id, "dan"))
    for page in pages:
        page.receive_until(6)
        assert page.follower is not None
        assert page.follower.state == service.mission(id)
        page.socket.close()
    assert pages[3].kinds == ["snapshot"]


def test_a_reconnected_client_receives_the_missed_revisions(service: Served) -> None:
    id = service.create(mission=data("a", "b", "c"))
    page = Page(service, id)
    page.receive_until(1)
    page.socket.close()
    rename(service, id, 1, "a", "A")
    rename(service, id, 2, "b", "B")
    page.connect()
    page.receive_until(3)
    assert "snapshot" not in page.kinds[1:]
    assert page.kinds.count("revision") == 2
    assert page.follower is not None
    assert page.follower.state == service.mission(id)
    page.socket.close()
    page.revision = 99  # an unknown revision
    page.connect()
    assert json.loads(page.socket.recv())["kind"] == "snapshot"
    page.socket.close()


def test_members_and_their_selections_are_sent(service: Served) -> None:
    id = service.create(mission=data("a", "b"))
    ann, bob = Page(service, id, "ann"), None
    ann.receive_until(1)
    bob = Page(service, id, "bob")
    bob.receive_until(1)
    assert [member["author"] for member in bob.members] == ["ann", "bob"]
    joined = ann.receive_kind("members")
    assert [member["author"] for member in joined["members"]] == ["ann", "bob"]
    bob.socket.send(json.dumps({"kind": "select", "names": ["b"]}))
    selected = ann.receive_kind("members")["members"]
    assert [member["selection"] for member in selected] == [[], ["b"]]
    bob.socket.close()
    assert [member["author"] for member in ann.receive_kind("members")["members"]] == ["ann"]
    ann.socket.close()


def test_names_versions_and_the_deletion_are_sent(service: Served) -> None:
    id = service.create(mission=data("a", "b"))
    page = Page(service, id)
    page.receive_until(1)
    service.client.put(f"/api/missions/{id}/name", json={"name": "Tour"})
    assert page.receive_kind("name")["name"] == "Tour"
    service.post(f"/api/missions/{id}/versions", "*", name="v")
    assert [v["name"] for v in page.receive_kind("versions")["versions"]] == ["v"]
    service.client.delete(f"/api/missions/{id}")
    assert page.receive_kind("deleted")
    with pytest.raises(ConnectionClosed):
        page.socket.recv(timeout=30)
    assert page.socket.close_code == 4404
    with pytest.raises(InvalidStatus, match="404"):
        service.follow(id)
