"""Uploads that take too long or too much, and others that do not wait for them."""

import asyncio
import json
import os
import sqlite3
import sys
from collections.abc import AsyncIterator
from contextlib import closing
from pathlib import Path
from runpy import run_path
from typing import ClassVar

import pytest

from argo_compiler.base.errors import Unavailable
from argo_compiler.base.limited_process import CallLimits
from argo_planner.service.jobs import imports
from argo_planner.service.jobs.imports import MOST_IMPORTS, MOST_OF_VISITOR, Imports
from tests.argo_planner.service.served import Served
from tests.argo_planner.service.test_http import data, problem

TASKS = [
    {
        "name": f"t{k}",
        "action": "MEASURE",
        "object_id": "1",
        "transitions": [{"target": f"t{k + 1}"}],
    }
    for k in range(50_000)
]
LARGE = json.dumps({"version": 3, "tasks": TASKS}).encode()
"""a mission of 4 MB"""


def upload(service: Served, name: str, content: bytes) -> dict:
    answer = service.client.post(f"/api/imports?filename={name}", content=content)
    return problem(answer, 422, answer.json()["code"])


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux limits the memory")
def test_an_upload_that_takes_too_much_memory_is_refused(service: Served, monkeypatch) -> None:
    monkeypatch.setattr(imports, "limits_for_size", lambda _: CallLimits(9.0, 20_000_000))
    refused = upload(service, "large.json", LARGE)
    # Python's own code ends in order, a compiled library may crash instead.
    assert refused["detail"].startswith("large.json takes more than 20 MB of memory to read")
    assert refused["detail"].endswith(": is it the right file? A mission takes far less")
    assert service.imported(json.dumps(data("a")), "small.json")


def test_an_upload_that_takes_too_long_is_refused(service: Served, monkeypatch) -> None:
    monkeypatch.setattr(imports, "limits_for_size", lambda _: CallLimits(0.05, 400_000_000))
    assert "large.json takes" in upload(service, "large.json", LARGE)["detail"]
    monkeypatch.undo()
    assert service.imported(json.dumps(data("a")), "small.json")


def test_a_mission_file_larger_than_any_is_refused_before_it_is_parsed(service: Served) -> None:
    refused = upload(service, "huge.json", b'{"version": 3, "tasks": [' + b" " * 43_000_000)
    assert "larger than 16 MB" in refused["detail"]


def test_a_bag_that_calculates_its_content_is_refused(service: Served, tmp_path: Path) -> None:
    path = tmp_path / "bag.db3"
    with closing(sqlite3.connect(path)) as database:
        database.execute("CREATE TABLE topics(id INTEGER)")
        database.execute("CREATE TABLE messages(id INTEGER, data AS (zeroblob(900000000)))")
        database.commit()
    assert "is calculated, not recorded" in upload(service, "b.db3", path.read_bytes())["detail"]


def test_the_bags_on_which_argo_hung_are_refused_when_uploaded(
    service: Served, fault_inputs: Path, tmp_path: Path, monkeypatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for script, file in (("endless", "evil.db3"), ("huge", "bomb.db3")):
        run_path(str(fault_inputs / f"{script}_bag.py"))
        content = (tmp_path / file).read_bytes()
        assert "is calculated, not recorded" in upload(service, file, content)["detail"]


def test_uploads_leave_no_files_behind(service: Served, monkeypatch, tmp_path: Path) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    upload(service, "m.json", b"{")
    assert service.imported(json.dumps(data("a")), "small.json")
    assert not list(tmp_path.iterdir())


class WaitingProcess:
    """Process of an import that never ends; the names of those that are read are listed."""

    reading: ClassVar[list[str]] = []

    def __class_getitem__(cls, _: object) -> type["WaitingProcess"]:
        return cls

    def __init__(self, _: object, __: object, name: str, *___: object, **____: object) -> None:
        self.name = name

    async def start_and_wait(self, _: object) -> None:
        self.reading.append(self.name)
        await asyncio.Event().wait()

    async def end(self) -> None:
        self.reading.remove(self.name)


async def nothing() -> AsyncIterator[bytes]:
    yield b""


async def megabytes(count: int) -> AsyncIterator[bytes]:
    yield bytes(count * 1_000_000)


@pytest.mark.anyio
async def test_an_upload_of_which_only_a_part_can_be_stored_is_refused() -> None:
    resource = pytest.importorskip("resource")
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1_000_000, before[1]))
    try:
        with pytest.raises(Unavailable, match="the upload can't be stored: File too large"):
            await Imports("umad").import_upload("script.txt", megabytes(2), "a")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


@pytest.mark.anyio
async def test_only_some_imports_of_a_visitor_wait(monkeypatch, tmp_path: Path) -> None:
    monkeypatch.setattr(imports, "JobProcess", WaitingProcess)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    reader = Imports("umad")
    tasks = [
        asyncio.ensure_future(reader.import_upload("first", nothing(), "a"))
        for _ in range(MOST_OF_VISITOR)
    ]
    await asyncio.sleep(0)
    with pytest.raises(Unavailable, match=f"{MOST_OF_VISITOR} imports with this token are under"):
        await reader.import_upload("one more", nothing(), "a")
    assert len(os.listdir(tmp_path)) == MOST_OF_VISITOR
    tasks.append(asyncio.ensure_future(reader.import_upload("other", nothing(), "b")))
    tasks.pop(0).cancel()
    await asyncio.sleep(0.05)
    tasks.append(asyncio.ensure_future(reader.import_upload("first", nothing(), "a")))
    await asyncio.sleep(0.05)
    assert len(os.listdir(tmp_path)) == MOST_OF_VISITOR + 1
    for task in tasks:
        task.cancel()
    await asyncio.gather(*tasks, return_exceptions=True)


@pytest.mark.anyio
async def test_one_visitor_does_not_take_the_turns_of_others(monkeypatch) -> None:
    monkeypatch.setattr(imports, "JobProcess", WaitingProcess)
    reader = Imports("umad")
    tasks = [asyncio.ensure_future(reader.import_upload("first", nothing(), "a")) for _ in range(6)]
    await asyncio.sleep(0.05)
    tasks.append(asyncio.ensure_future(reader.import_upload("second", nothing(), "b")))
    tasks.append(asyncio.ensure_future(reader.import_upload("third", nothing(), "c")))
    await asyncio.sleep(0.05)
    assert WaitingProcess.reading == ["first", "second"]
    assert len(WaitingProcess.reading) == MOST_IMPORTS
    for task in tasks:
        task.cancel()
    await asyncio.gather(*tasks, return_exceptions=True)
    assert not WaitingProcess.reading
