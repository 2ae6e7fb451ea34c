"""An assistant behind an endpoint that speaks the chat-completions interface, over HTTP."""

import json
import threading
from collections.abc import Callable
from concurrent.futures import Future
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

from argo_compiler.base.errors import Invalid, Unavailable
from argo_compiler.base.extras import install_line
from argo_compiler.base.message import Message
from argo_compiler.script.assistant.request import AssistantRequest

if TYPE_CHECKING:
    import httpx

_PATH = "/chat/completions"
_LOCAL = ("localhost", "127.0.0.1", "::1")
_ENVELOPE = 4
"""how many times larger than an answer the response may be that carries it"""


def endpoint_url(address: str) -> str:
    """Return the URL of an endpoint, to which the path of the interface is added if it is missing.

    Raises:
        Invalid: It is no URL of HTTP.
    """
    try:
        parts = urlsplit(address)
        valid = parts.scheme in ("http", "https") and bool(parts.hostname) and parts.port != 0
    except ValueError:
        valid = False
    if not valid or parts.query or parts.fragment or parts.username or parts.password:
        raise Invalid(
            Message(
                "{address} is no address of an endpoint, such as http://localhost:8080/v1",
                address=address,
            )
        )
    return address if parts.path.endswith(_PATH) else f"{address.rstrip('/')}{_PATH}"


def ask_endpoint(
    url: str,
    request: AssistantRequest,
    model: str | None,
    key: str | None,
    max_bytes: int,
    timeout_s: float,
) -> bytes:
    """Send a request to an endpoint, and return the content of its answer.

    Raises:
        Invalid: The key would be sent in clear text, or the answer is of another form.
        Unavailable: httpx is not installed, or the endpoint can't be reached, refuses, or takes
            too long.
    """
    try:
        import httpx
    except ImportError:
        raise Unavailable(
            Message(
                "an endpoint needs httpx: {install_line}", install_line=install_line("assistant")
            )
        ) from None
    host = urlsplit(url).hostname
    local = host in _LOCAL
    if key and not local and not url.startswith("https:"):
        raise Invalid(
            Message("{url} is not encrypted, so the key is not sent to it: use https", url=url)
        )
    headers = {"Accept-Encoding": "identity"} | ({"Authorization": f"Bearer {key}"} if key else {})
    body: dict[str, Any] = {
        "messages": [
            {"role": "system", "content": request.instructions},
            {"role": "user", "content": request.material},
        ],
        "temperature": 0,
        "stream": False,
    }
    if model:
        body["model"] = model

    def post() -> bytes:
        # A proxy would be one more place that the script goes to; this machine needs none.
        with httpx.Client(timeout=timeout_s, trust_env=not local) as client:
            return _post(client, url, headers, body, max_bytes * _ENVELOPE)

    try:
        response = _within(timeout_s, post)
    except httpx.TimeoutException:
        raise Unavailable(
            Message("it has not answered within {timeout_s:g} s", timeout_s=timeout_s)
        ) from None
    except (httpx.HTTPError, httpx.InvalidURL, ValueError) as error:
        raise Unavailable(
            Message("it can't be asked: {value}", value=error or type(error).__name__)
        ) from None
    return _content_of(response)


def _within(seconds: float, call: Callable[[], bytes]) -> bytes:
    """Return what a call returns; raise Unavailable if that takes longer.

    The limits of the client are for each of its steps, and a server may send byte by byte.
    """
    result: Future[bytes] = Future()

    def run() -> None:
        try:
            result.set_result(call())
        except Exception as error:  # raised again where the result is asked for
            result.set_exception(error)

    threading.Thread(target=run, daemon=True).start()
    try:
        return result.result(seconds)
    except TimeoutError:
        raise Unavailable(
            Message("it has not answered within {seconds:g} s", seconds=seconds)
        ) from None


def _post(
    client: "httpx.Client", url: str, headers: dict[str, str], body: dict[str, Any], max_bytes: int
) -> bytes:
    content = bytearray()
    with client.stream("POST", url, headers=headers, json=body) as response:
        if response.is_redirect:
            raise Unavailable("it sends to another address; give that one")
        if response.status_code != 200:
            raise Unavailable(
                Message("it refuses with status {status_code}", status_code=response.status_code)
            )
        for part in response.iter_bytes(65536):
            content += part
            if len(content) > max_bytes:
                raise Invalid(
                    Message("the answer is larger than {max_bytes:,} bytes", max_bytes=max_bytes)
                )
    return bytes(content)


def _content_of(response: bytes) -> bytes:
    """Return the text of the first message of a response."""
    try:
        content = json.loads(response)["choices"][0]["message"]["content"]
    except (ValueError, RecursionError, LookupError, TypeError):
        content = None
    if not isinstance(content, str):
        raise Invalid("its response is none of the chat-completions interface")
    return content.encode("utf-8", "replace")
