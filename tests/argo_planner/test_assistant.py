"""`argo import --assistant`: commands and endpoints that answer well, badly or not at all."""

import json
import shlex
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest

from argo_compiler.files.mission_file import read_mission
from tests.argo_planner.conftest import argo

SCRIPT = "Start in starting area 1.\nCheck valve R7.\nBefriend valve R12 and the others.\n"
ANSWER = '{"lines": [{"line": 3, "words": "valve R12", "sentence": "Check checkpoint 5."}]}'
PROPOSED = "proposed: Check checkpoint 5."


@pytest.fixture
def script(tmp_path: Path) -> Path:
    path = tmp_path / "mail.txt"
    path.write_text(SCRIPT, encoding="utf-8")
    return path


def command(folder: Path, program: str) -> str:
    """Return a command that runs a program in Python."""
    path = folder / "assistant.py"
    path.write_text(program, encoding="utf-8")
    return shlex.join([sys.executable, "-S", str(path)])


def ask(script: Path, assistant: str, *options: object, status: int = 3) -> str:
    """Import a script with an assistant, and return what is shown."""
    output = script.with_name("m.json")
    result = argo("import", script, "-o", output, "--assistant", assistant, *options)
    found = getattr(result.exception, "code", None)
    text = f"{result.output}{result.exception or ''}"
    if found != "incomplete":
        assert result.exit_code == (status if status != 2 else 1), text
    else:
        assert status == 3, text
    return text


def draft(script: Path) -> str:
    return script.with_name("mail.txt.draft").read_text(encoding="utf-8")


def test_a_suggestion_is_kept_and_counts_when_it_is_confirmed(script: Path, tmp_path: Path) -> None:
    program = f"import sys; open({str(tmp_path / 'asked')!r}, 'a').write(sys.stdin.read())\n"
    assistant = command(tmp_path, f"{program}print({ANSWER!r})")
    shown = ask(script, assistant)
    assert "sending to the assistant" in shown
    assert "the script (3 lines, 1 of them open), the" in shown
    assert PROPOSED in draft(script)
    assert "not used: Befriend, and the others" in draft(script)
    asked = (tmp_path / "asked").read_text(encoding="utf-8")
    assert "3: Befriend valve R12 and the others." in asked
    size = f"{len(asked.encode()):,} bytes"
    assert size in shown.replace("\n", " ")

    again = ask(script, assistant)
    assert "no line is left that the assistant has not been asked about" in again
    assert (tmp_path / "asked").read_text(encoding="utf-8") == asked
    kept = draft(script)
    argo("import", script, "-o", tmp_path / "m.json")
    assert draft(script) == kept

    argo("import", script, "-o", tmp_path / "m.json", "--confirm", "3", status=0)
    tasks = read_mission(tmp_path / "m.json").tasks
    assert [task.object_id for task in tasks if task.object_id] == ["11", "5"]


@pytest.mark.parametrize(
    ("program", "message"),
    [
        ("print('I would rather not.')", "no JSON object"),
        ("print('{\"tasks\": 3}')", "not of the form that was asked for: lines: field required"),
        ("print('x' * 10_000_000)", "larger than 1,000,000 bytes"),
        ("import os; os.write(1, b'\\xff\\xfe{')", "not UTF-8"),
        ("print('{\"lines\": NaN}')", "not of the form"),
        ("import sys; sys.exit('no model \\x1b[31m here')", "failed with status 1: no model"),
        ("import os, signal; os.kill(os.getpid(), signal.SIGKILL)", "failed with status -9"),
        ("", "no JSON object"),
        ("import time; time.sleep(60)", "has not answered within 0.5 s"),
        ("import os, time; os.close(1); time.sleep(60)", "within 0.5 s"),
        ("while True: print('noise')", "larger than 1,000,000 bytes"),
        (
            "import os; print(1, flush=True)\nif os.fork() == 0: os.execlp('sleep', 'sleep', '60')",
            "not of the form",
        ),
    ],
    ids=range(12),
)
def test_an_assistant_that_fails_leaves_the_draft_without_it(
    program: str, message: str, script: Path, tmp_path: Path
) -> None:
    argo("import", script, "-o", tmp_path / "m.json")
    before = draft(script)
    started = time.monotonic()
    limit = "0.5 s" if "sleep(60)" in program else "20 s"
    shown = ask(script, command(tmp_path, program), "--assistant-timeout", limit)
    assert message in shown
    assert shown.count("the draft is without it") == 1
    assert "\x1b" not in shown
    assert draft(script) == before
    assert time.monotonic() - started < 20


def test_a_command_that_reads_nothing_and_a_long_script(script: Path, tmp_path: Path) -> None:
    """The request is larger than what a pipe holds."""
    script.write_text(SCRIPT + "Note: nothing to do here.\n" * 3_000, encoding="utf-8")
    ask(script, command(tmp_path, f"print({ANSWER!r})"))
    assert PROPOSED in draft(script)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--assistant", "no-such-program-here"], "it can't be started"),
        (["--assistant", "'unfinished"], "is no command"),
        (["--assistant", "ftp://x"], "it can't be started"),
        (["--assistant", "http://"], "is no address of an endpoint"),
        (["--assistant", "https://me:secret@localhost/v1"], "is no address of an endpoint"),
        (["--assistant", "   "], "name a command or the URL"),
        (["--assistant", "cat", "--assistant-model", "x"], "is for endpoints"),
        (["--assistant-model", "x"], "need --assistant"),
        (["--assistant-timeout", "5 s"], "need --assistant"),
    ],
)
def test_wrong_options_have_one_message(
    options: list[str], message: str, script: Path, tmp_path: Path
) -> None:
    result = argo("import", script, "-o", tmp_path / "m.json", *options)
    assert message in f"{result.output}{result.exception}"
    assert not (tmp_path / "m.json").exists()


class Endpoint:
    """A server of the chat-completions interface that answers as it is told to."""

    def __init__(self) -> None:
        self.response: bytes = completion(ANSWER)
        self.status = 200
        self.headers: dict[str, str] = {}
        self.pause_s = 0.0
        self.requests: list[tuple[str, dict[str, str], dict]] = []
        self.url = ""


def completion(content: object) -> bytes:
    return json.dumps({"choices": [{"message": {"content": content}}]}).encode()


@contextmanager
def serving(endpoint: Endpoint) -> Iterator[None]:
    class Handler(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            body = self.rfile.read(int(self.headers["Content-Length"]))
            endpoint.requests.append((self.path, dict(self.headers), json.loads(body)))
            self.send_response(endpoint.status)
            for name, value in endpoint.headers.items():
                self.send_header(name, value)
            self.end_headers()
            for at in range(0, len(endpoint.response), 1 << 16):
                time.sleep(endpoint.pause_s)
                self.wfile.write(endpoint.response[at : at + (1 << 16)])

        def log_message(self, *_: object) -> None:
            pass

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    server.daemon_threads = True
    endpoint.url = f"http://127.0.0.1:{server.server_port}/v1"
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        yield
    finally:
        server.shutdown()
        server.server_close()


@pytest.fixture
def endpoint() -> Iterator[Endpoint]:
    found = Endpoint()
    with serving(found):
        yield found


def test_an_endpoint_is_asked_with_the_usual_interface(
    script: Path, endpoint: Endpoint, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ARGO_ASSISTANT_KEY", "a-secret")
    monkeypatch.setenv("HTTP_PROXY", "http://127.0.0.1:1")  # is not used for this machine
    shown = ask(script, endpoint.url, "--assistant-model", "small")
    assert f"sending to the assistant `{endpoint.url}/chat/completions`" in shown
    assert "a-secret" not in shown
    assert PROPOSED in draft(script)
    assert "a-secret" not in draft(script)
    ((path, headers, body),) = endpoint.requests
    assert path == "/v1/chat/completions"
    assert headers["Authorization"] == "Bearer a-secret"
    assert body["model"] == "small"
    assert [message["role"] for message in body["messages"]] == ["system", "user"]
    assert "Befriend valve R12" in body["messages"][1]["content"]


def test_without_a_key_none_is_sent(
    script: Path, endpoint: Endpoint, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("ARGO_ASSISTANT_KEY", raising=False)
    ask(script, f"{endpoint.url}/chat/completions")
    ((path, headers, body),) = endpoint.requests
    assert path == "/v1/chat/completions"
    assert "Authorization" not in headers
    assert "model" not in body


def test_a_key_is_never_sent_in_clear_text_to_another_machine(
    script: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ARGO_ASSISTANT_KEY", "a-secret")
    assert "is not encrypted" in ask(script, "http://192.0.2.1/v1")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"status": 500}, "refuses with status 500"),
        ({"status": 401}, "refuses with status 401"),
        ({"status": 302, "headers": {"Location": "http://192.0.2.1/"}}, "to another address"),
        ({"response": b"<html>"}, "none of the chat-completions interface"),
        ({"response": b'{"choices": []}'}, "none of the chat-completions interface"),
        ({"response": b"[" * 100_000}, "none of the chat-completions interface"),
        ({"response": completion(None)}, "none of the chat-completions interface"),
        ({"response": completion("no")}, "no JSON object"),
        ({"response": b" " * 10_000_000}, "larger than"),
        ({"pause_s": 5.0}, "has not answered within 0.5 s"),
        ({"response": b" " * 3_000_000, "pause_s": 0.1}, "has not answered within 0.5 s"),
    ],
    ids=range(11),
)
def test_an_endpoint_that_fails_leaves_the_draft_without_it(
    change: dict, message: str, script: Path, endpoint: Endpoint
) -> None:
    for name, value in change.items():
        setattr(endpoint, name, value)
    limit = "0.5 s" if "pause_s" in change else "20 s"
    shown = ask(script, endpoint.url, "--assistant-timeout", limit)
    assert message in shown
    assert shown.count("the draft is without it") == 1
    assert PROPOSED not in draft(script)


def test_nobody_listens(script: Path) -> None:
    assert "it can't be asked" in ask(script, "http://127.0.0.1:1/v1")


def test_a_mission_has_no_lines_for_an_assistant(tmp_path: Path) -> None:
    bag = tmp_path / "x.bag"
    bag.write_bytes(b"#ROSBAG V2.0\n")
    result = argo("import", bag, "-o", tmp_path / "m.json", "--assistant", "cat")
    assert "is no script" in f"{result.output}{result.exception}"
