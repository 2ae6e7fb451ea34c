"""Rooms: slow clients, and commands that are completed although their sender is gone."""

import asyncio
import json
import threading
from datetime import UTC, datetime
from itertools import count

import pytest

from argo_compiler.base.catalog import Catalog
from argo_compiler.base.errors import Conflict
from argo_compiler.editing import commands as edits
from argo_planner.service.core.commands import EditPlan
from argo_planner.service.rooms import mailbox as mailboxes
from argo_planner.service.rooms.mailbox import Mailbox, MailboxClosed
from argo_planner.service.rooms.room import PlanRoom
from argo_planner.service.rooms.rooms import PlanRooms
from argo_planner.service.storage import folder as folders
from argo_planner.service.storage.folder import PlanFolder
from tests.argo_planner.service.served import waiting_messages
from tests.argo_planner.service.test_plan import mission

pytestmark = pytest.mark.anyio


def now() -> datetime:
    return datetime(2026, 1, 2, tzinfo=UTC)


@pytest.fixture
async def rooms(tmp_path):
    numbers = count(1)
    folder = PlanFolder(tmp_path, lambda: f"{next(numbers):012x}")
    nothing = Catalog(site="x", checkpoints=(), areas=(), floors=())
    rooms = PlanRooms(folder, nothing, None, now)
    yield rooms
    await rooms.close()


def rename_command(k: int) -> EditPlan:
    old = "a" if k == 1 else f"a{k - 1}"
    return EditPlan(id=f"k{k}", edits=(edits.RenameTask(name=old, new_name=f"a{k}"),))


async def test_only_the_newest_pose_and_all_events_are_sent() -> None:
    mailbox = Mailbox()
    for k in range(5):
        mailbox.post_newest("pose", f"pose {k}")
        mailbox.post(f"event {k}")
    mailbox.close(MailboxClosed("over"))
    mailbox.post("too late")
    messages = [await mailbox.next_message() for _ in range(6)]
    with pytest.raises(MailboxClosed, match="over"):
        await mailbox.next_message()
    assert messages == [*(f"event {k}" for k in range(5)), "pose 4"]


async def test_a_slow_client_is_disconnected_delays_nobody_and_resumes(rooms, monkeypatch) -> None:
    monkeypatch.setattr(mailboxes, "MOST_MESSAGES", 10)
    room = await rooms.create("Round", mission("a", "b"))
    slow, quick = room.join("1", "ann"), room.join("2", "bob")
    messages = []
    for k in range(1, 21):
        await room.execute(rename_command(k), "ann", k)
        messages += await waiting_messages(quick, "revision")
    assert [message["revision"]["number"] for message in messages] == [*range(2, 22)]
    with pytest.raises(MailboxClosed) as closed:
        await slow.next_message()
    assert closed.value.too_slow
    room.leave("1")
    monkeypatch.setattr(mailboxes, "MOST_MESSAGES", 100)
    again = await waiting_messages(room.join("3", "ann", since=11), "revision")
    assert [message["revision"]["number"] for message in again] == [*range(12, 22)]


async def test_a_new_client_may_get_many_messages_at_first(monkeypatch) -> None:
    monkeypatch.setattr(mailboxes, "MOST_MESSAGES", 2)
    mailbox = Mailbox(f"past {k}" for k in range(5))
    mailbox.post("event 0")
    mailbox.post("event 1")
    messages = [await mailbox.next_message() for _ in range(6)]
    assert messages == [*(f"past {k}" for k in range(5)), "event 0"]
    mailbox.post("event 2")
    mailbox.post("event 3")
    with pytest.raises(MailboxClosed) as closed:
        await mailbox.next_message()
    assert closed.value.too_slow


async def test_a_command_is_completed_although_its_sender_is_gone(rooms) -> None:
    room = await rooms.create("Round", mission("a", "b"))
    page = room.join("1", "ann")
    sending = asyncio.ensure_future(room.execute(rename_command(1), "ann", 1))
    await asyncio.sleep(0)
    sending.cancel()
    with pytest.raises(asyncio.CancelledError):
        await sending
    done = await room.execute(rename_command(2), "ann", 2)
    assert done.newest == 3
    assert len(await waiting_messages(page, "revision")) == 2


async def test_simultaneous_commands_are_executed_one_after_the_other(rooms) -> None:
    room = await rooms.create("Round", mission("a", "b"))
    answers = await asyncio.gather(
        *(room.execute(rename_command(1), "ann", 1) for _ in range(5)),
        room.execute(EditPlan(id="x", edits=(edits.RemoveTask(name="b"),)), "bob", None),
    )
    assert [answer.revision.number for answer in answers] == [2, 2, 2, 2, 2, 3]


async def test_a_closed_room_refuses(rooms) -> None:
    room: PlanRoom = await rooms.create("Round", mission("a", "b"))
    await rooms.delete(room.document.id)
    with pytest.raises(Conflict, match="closed or deleted"):
        await room.execute(rename_command(1), "ann", 1)
    with pytest.raises(Conflict):
        room.join("1", "ann")
    back = await rooms.restore(room.document.id)
    assert back.document.plan.mission == mission("a", "b")


async def test_unused_rooms_are_closed(rooms, monkeypatch) -> None:
    monkeypatch.setattr("argo_planner.service.rooms.rooms.MOST_OPEN", 2)
    used = await rooms.create("used", mission("a"))
    used.join("1", "ann")
    others = [await rooms.create(str(k), mission("a")) for k in range(5)]
    with pytest.raises(Conflict):
        others[0].join("2", "bob")
    await used.execute(rename_command(1), "ann", 1)
    assert (await rooms.open(others[0].document.id)).document.name == "0"
    assert len(await rooms.list_plans()) == 6


async def test_files_of_open_plans_are_not_read_for_a_list(rooms, monkeypatch) -> None:
    read = []
    monkeypatch.setattr(folders, "read_plan_summary", read.append)
    room = await rooms.create("Round", mission("a", "b"))
    await room.execute(rename_command(1), "ann", 1)
    (listed,) = await rooms.list_plans()
    assert (listed.name, listed.revision) == ("Round", 2)
    assert read == []


async def test_a_client_that_joins_during_a_command_gets_its_revision_once(rooms) -> None:
    room = await rooms.create("Round", mission("a", "b"))
    for k in range(1, 31):
        sending = asyncio.ensure_future(room.execute(rename_command(k), "ann", k))
        for _ in range(k % 7):
            await asyncio.sleep(0.001)
        page = room.join(str(k), "bob")
        await sending
        first = [json.loads(await page.next_message())]
        known = first[0]["state"]["revision"]
        later = [m["revision"]["number"] for m in await waiting_messages(page, "revision")]
        assert later == [*range(known + 1, k + 2)]
        room.leave(str(k))


async def test_an_edit_does_not_wait_for_other_work_in_threads(rooms) -> None:
    room = await rooms.create("Round", mission("a", "b"))
    free = threading.Event()
    others = [asyncio.ensure_future(asyncio.to_thread(free.wait)) for _ in range(100)]
    await asyncio.sleep(0.05)
    try:
        done = await asyncio.wait_for(room.execute(rename_command(1), "ann", 1), 30)
    finally:
        free.set()
        await asyncio.gather(*others)
    assert done.newest == 2
