"""Requests of attackers: each is refused with one clear answer, and the service still works."""

import json
import socket
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress

import httpx
import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection

from argo_planner.service.web import guard
from argo_planner.service.web.access import AccessRole, AccessToken, TokenBook
from argo_planner.service.web.connections import (
    MAX_CONNECTIONS,
    LimitedProtocol,
    raise_file_limit_for_connections,
)
from tests.argo_planner.service.served import ALL, SECRETS, Served, send_raw
from tests.argo_planner.service.test_http import data, problem


@pytest.fixture(autouse=True)
def service_still_works(service: Served, monkeypatch: pytest.MonkeyPatch):
    """Check after each test that the service works with its own limits."""
    yield
    monkeypatch.undo()
    id = service.create(mission=data("a", "b"))
    assert service.command(id, 1, {"kind": "remove_task", "name": "b"}).status_code == 200


@pytest.mark.parametrize(
    "headers",
    [
        {"host": "evil.example"},
        {"host": "evil.example:80"},
        {"host": "localhost.evil.example"},
        {"host": ""},
        {"origin": "http://evil.example"},
        {"origin": "null"},
        {"origin": "http://127.0.0.1:1"},
        {"origin": "file://"},
        {"sec-fetch-site": "cross-site"},
    ],
)
def test_requests_from_other_hosts_or_origins_are_refused(
    service: Served, headers: dict[str, str]
) -> None:
    for answer in (
        service.client.get("/api/missions", headers=headers),
        service.client.post("/api/missions", json={"name": "x"}, headers=headers),
    ):
        assert answer.status_code == 403
        assert answer.json()["code"] in ("foreign-host", "foreign-origin")
        assert "content-security-policy" in answer.headers
    if "host" not in headers:  # the WebSocket library always sends its own host
        path = f"/api/missions/{service.create()}/live"
        with pytest.raises(InvalidStatus, match="403"):
            service.socket(path, {"authorization": f"Bearer {ALL}"} | headers)


@pytest.mark.parametrize(
    "headers",
    [
        {"authorization": ""},
        {"authorization": "Bearer wrong"},
        {"authorization": f"Basic {ALL}"},
        {"authorization": "Bearer", "cookie": "argo=x"},
        {"authorization": "Bearer é"},
    ],
)
def test_requests_without_a_valid_token_are_refused(
    service: Served, headers: dict[str, str]
) -> None:
    sent = {k: v.encode() for k, v in headers.items()}
    for path in ("/", "/api/missions", "/api/openapi.json", "/api/nothing"):
        answer = service.client.get(path, headers=sent)
        problem(answer, 401, "token-missing")
        assert answer.headers["www-authenticate"] == "Bearer"
    with pytest.raises(InvalidStatus, match="401"):
        service.socket(f"/api/missions/{'0' * 12}/live", {})


def test_the_address_with_the_token_sets_a_cookie(service: Served) -> None:
    client = service.client
    client.headers.pop("authorization")
    try:
        entered = client.get("/", params={"token": ALL, "mission": "5"})
        assert (entered.status_code, entered.headers["location"]) == (303, "/?mission=5")
        cookie = entered.headers["set-cookie"]
        assert "HttpOnly" in cookie
        assert "samesite=strict" in cookie.lower()
        assert ALL not in cookie
        page = client.get("/")  # the client keeps the cookie
        assert page.status_code == 200
        assert "unsafe-eval" not in page.headers["content-security-policy"]
        away = f"GET //evil.example/x?token={ALL} HTTP/1.1\r\nHost: localhost\r\n"
        answer = send_raw(service.address, f"{away}Connection: close\r\n\r\n".encode())
        assert b"\r\nlocation: /evil.example/x\r\n" in answer
        problem(client.get("/", params={"token": "wrong"}), 401, "token-missing")
    finally:
        client.cookies.clear()
        client.headers["authorization"] = f"Bearer {ALL}"


@pytest.mark.parametrize(
    "path",
    [
        "/api/missions/../../../etc/passwd",
        "/api/missions/..%2f..%2fetc%2fpasswd",
        "/api/missions/%2e%2e",
        "/api/missions/000000000000%00",
        "/api/missions/ABCDEFABCDEF",
        "/api/missions/0000000000000",
        "/api/bin/..%2f000000000000/restore",
    ],
)
def test_no_path_leads_out_of_the_folder(service: Served, path: str) -> None:
    for method in ("GET", "DELETE", "POST"):
        answer = send_raw(
            service.address,
            f"{method} {path} HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer {ALL}\r\n"
            "Connection: close\r\nContent-Length: 0\r\n\r\n".encode(),
        )
        status = int(answer.split()[1])
        assert status in (400, 404, 405, 422), answer
        assert b"root:" not in answer


def test_a_link_out_of_the_folder_is_not_followed(service: Served, tmp_path) -> None:
    id = service.create(mission=data("a"))
    service.client.delete(f"/api/missions/{id}")
    file = service.folder / "bin" / f"{id}.plan"
    file.rename(tmp_path / "elsewhere")
    (service.folder / f"{id}.plan").symlink_to(tmp_path / "elsewhere")
    file.symlink_to(tmp_path / "elsewhere")
    for answer in (
        service.client.get(f"/api/missions/{id}"),
        service.client.delete(f"/api/missions/{id}"),
        service.client.post(f"/api/bin/{id}/restore"),
        service.client.delete(f"/api/bin/{id}"),
    ):
        problem(answer, 404, "not-found")
    assert id not in service.client.get("/api/missions").text
    assert (tmp_path / "elsewhere").exists()


def test_bodies_of_100_mb_are_refused(service: Served) -> None:
    problem(service.client.post("/api/missions", content=b"x" * 3_000_000), 413, "too-large")
    head = f"POST /api/missions HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer {ALL}\r\n"
    with_size = send_raw(service.address, f"{head}Content-Length: 100000000\r\n\r\n".encode())
    assert b" 413 " in with_size.split(b"\r\n")[0]
    chunk = b"10000\r\n" + b"x" * 65_536 + b"\r\n"
    without_size = send_raw(
        service.address,
        head.encode()
        + b"Connection: close\r\nTransfer-Encoding: chunked\r\n\r\n"
        + chunk * 1_600
        + b"0\r\n\r\n",
    )
    assert without_size.split()[1] in (b"413", b"400"), without_size[:300]


def test_missions_that_are_too_large_are_refused(service: Served) -> None:
    tasks = b",".join(
        b'{"name":"t%d","action":"MEASURE","object_id":"1"}' % k for k in range(1_000_000)
    )
    content = b'{"version":3,"tasks":[' + tasks + b"]}"
    answer = service.client.post("/api/imports?filename=m.json", content=content)
    assert answer.status_code in (413, 422), answer.text
    many = data(*(f"t{k}" for k in range(10_001)))
    for task in many["tasks"]:
        task["object_id"] = "1"
    answer = service.client.post("/api/imports?filename=m.json", content=json.dumps(many).encode())
    problem(answer, 422, "plan-too-large")


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("x" * 1_000_000, "at most"),
        ("x" * 201, "at most 200"),
        ("a\0b", "invisible character"),
        ("a\u202egnp.exe", "invisible character"),
        ("", "needs a name"),
    ],
)
def test_texts_that_can_not_be_names_are_refused(service: Served, name: str, reason: str) -> None:
    id = service.create(mission=data("a", "b"))
    for answer in (
        service.client.post("/api/missions", json={"name": name}),
        service.client.put(f"/api/missions/{id}/name", json={"name": name}),
        service.command(id, 1, {"kind": "rename_task", "name": "a", "new_name": name}),
    ):
        assert answer.status_code in (409, 422), answer.text[:300]
        assert len(answer.content) < 5_000
        assert reason in answer.text or "empty" in answer.text or "is to be" in answer.text


def test_a_name_with_markup_is_returned_as_text(service: Served) -> None:
    name = "<img src=x onerror=alert(1)> גשר"
    id = service.create(name)
    answer = service.client.get(f"/api/missions/{id}")
    assert answer.json()["name"] == name
    assert answer.headers["content-type"] == "application/json"
    assert answer.headers["x-content-type-options"] == "nosniff"


@pytest.mark.parametrize(
    "body",
    [
        b"[" * 100_000,
        b'{"name": ' + b"9" * 10_000 + b"}",
        b'{"name": NaN}',
        b'{"name": "\\ud800"}',
        b"\xff\xfe",
        b"",
        b"null",
    ],
)
def test_malformed_bodies_are_refused(service: Served, body: bytes) -> None:
    answer = service.client.post(
        "/api/missions", content=body, headers={"content-type": "application/json"}
    )
    assert answer.status_code in (400, 422), answer.text
    assert answer.json()["code"] == "invalid"


@pytest.mark.parametrize(
    "text",
    [
        "nothing",
        "[" * 50_000,
        '{"kind":"select"}',
        '{"kind":"select","names":["' + "x" * 201 + '"]}',
        '{"kind":"move","names":[]}',
        b"\x00\xff",
    ],
)
def test_malformed_messages_end_the_connection(service: Served, text: str) -> None:
    id = service.create(mission=data("a"))
    page = service.follow(id)
    page.recv()
    with pytest.raises(ConnectionClosed):
        send_and_receive_all(page, text)
    assert page.close_code in (4400, 1009)


def test_a_message_of_two_megabytes_ends_the_connection(service: Served) -> None:
    page = service.follow(service.create(mission=data("a")))
    page.recv()
    with pytest.raises(ConnectionClosed):  # perhaps while it is sent; then there is no close code
        send_and_receive_all(page, "x" * 2_000_000)


def test_a_message_whose_header_states_too_long_a_text_ends_the_connection(service: Served) -> None:
    page = service.follow(service.create(mission=data("a")))
    page.recv()
    text, masked_of_64_bits = 0x81, 0x80 | 127
    head = bytes([text, masked_of_64_bits]) + (2_000_000).to_bytes(8, "big") + bytes(4)
    page.socket.sendall(head)  # the service does not wait for the rest of the message
    with pytest.raises(ConnectionClosed):
        receive_all(page)
    assert page.close_code == 1009


def send_and_receive_all(page: ClientConnection, text: str) -> None:
    """Send a text, and receive all messages."""
    page.send(text)
    receive_all(page)


def receive_all(page: ClientConnection) -> None:
    while True:
        page.recv(timeout=30)


@pytest.mark.long
def test_ten_thousand_connections_do_not_block_other_clients(service: Served) -> None:
    raise_file_limit_for_connections()
    host, _, port = service.address.partition(":")
    connections: list[socket.socket] = []
    try:
        for k in range(10_000):
            connections.append(socket.create_connection((host, int(port)), timeout=60))
            if len(connections) > MAX_CONNECTIONS + 500:
                connections.pop(0).close()
            if k % 1_000 == 0:
                assert service.as_("ann").get("/api/missions").status_code == 200
        assert service.as_("ann").get("/api/missions").status_code == 200
    finally:
        for one in connections:
            one.close()


def test_a_page_beyond_the_limit_of_connections_is_refused(service: Served, monkeypatch) -> None:
    monkeypatch.setattr("argo_planner.service.web.live.MAX_SOCKETS", 3)
    id = service.create(mission=data("a"))
    pages = [service.follow(id) for _ in range(3)]
    with pytest.raises(InvalidStatus, match="503"):
        service.follow(id)
    for page in pages:
        page.close()
    with ThreadPoolExecutor(4) as pool:
        assert all(
            answer.status_code == 200
            for answer in pool.map(lambda _: service.client.get("/api/missions"), range(20))
        )


def send_unfinished(service: Served, count: int, secret: str = ALL) -> list[socket.socket]:
    """Open connections whose requests lack the rest of their bodies."""
    host, _, port = service.address.partition(":")
    head = (
        f"POST /api/missions HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer {secret}\r\n"
        "Content-Type: application/json\r\nContent-Length: 1000\r\n\r\n{"
    )
    connections = []
    for _ in range(count):
        connections.append(socket.create_connection((host, int(port)), timeout=30))
        connections[-1].sendall(head.encode())
    return connections


def status_of(connection: socket.socket) -> bytes:
    return connection.recv(65_536).split(b" ")[1]


def test_unfinished_bodies_of_one_token_do_not_block_other_tokens(
    service: Served, monkeypatch
) -> None:
    monkeypatch.setattr(guard, "MOST_REQUESTS", 5)
    connections = send_unfinished(service, 8)
    try:
        assert [status_of(one) for one in connections[5:]] == [b"503"] * 3
        other = service.as_("bob", SECRETS[AccessRole.PLAN])
        assert other.get("/api/missions").status_code == 200
        refused = problem(service.client.get("/api/missions"), 503, "unavailable")
        assert "5 requests with this token are under way" in refused["detail"]
    finally:
        for one in connections:
            one.close()


def test_a_body_that_does_not_arrive_is_refused(service: Served, monkeypatch) -> None:
    monkeypatch.setattr(guard, "PART_TIMEOUT", 0.2)
    [connection] = send_unfinished(service, 1)
    with connection:
        answer = connection.recv(65_536)
        assert answer.startswith(b"HTTP/1.1 503 ")
        assert b"no part of the request's body arrived" in answer + connection.recv(65_536)


def test_a_body_that_arrives_too_slowly_is_refused(service: Served, monkeypatch) -> None:
    monkeypatch.setattr(guard, "REQUEST_TIMEOUT", 0.5)
    [connection] = send_unfinished(service, 1)
    connection.settimeout(0.05)
    answer = b""
    with connection:
        while not answer:
            connection.sendall(b" ")
            with suppress(TimeoutError):
                answer = connection.recv(65_536)
    assert answer.startswith(b"HTTP/1.1 503 ")


@pytest.mark.anyio
async def test_an_error_of_the_service_is_no_late_answer() -> None:
    async def fail(*_: object) -> None:
        raise TimeoutError("of the service's own")

    settings = guard.GuardSettings(frozenset(["localhost"]))
    guarded = guard.Guard(fail, TokenBook([AccessToken(ALL)]), settings)
    transport = httpx.ASGITransport(guarded)
    async with httpx.AsyncClient(transport=transport, base_url="http://localhost") as client:
        with pytest.raises(TimeoutError, match="of the service's own"):
            await client.get("/", headers={"authorization": f"Bearer {ALL}"})


def test_connections_that_are_idle_make_room_for_others(service: Served, monkeypatch) -> None:
    monkeypatch.setattr(LimitedProtocol, "limit", 4)
    clients = [service.as_(f"person {k}") for k in range(12)]
    assert [one.get("/api/missions").status_code for one in clients] == [200] * 12
