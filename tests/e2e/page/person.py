"""People at the page: real browsers, whose inputs are counted, and lines that can be cut."""

import os
import shutil
import socket
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any
from urllib.parse import urlsplit

import pytest
from playwright.sync_api import (
    Browser,
    BrowserContext,
    ConsoleMessage,
    Page,
    Request,
    expect,
    sync_playwright,
)

CHROMIUM = os.environ.get("ARGO_CHROMIUM") or shutil.which("chromium")
NO_CHROMIUM = "the page is tested in Chromium: install Debian's package `chromium`"
_OPTIONS = [
    "--no-sandbox",
    "--enable-unsafe-swiftshader",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]
PATIENCE_S = 240
"""after which a test gives up: far more than anything takes, also on a busy machine"""
expect.set_options(timeout=1000 * PATIENCE_S)

# Not the page's: what the browser says of its software renderer, and that a request was refused,
# which the page shows as a message.
_NOT_OURS = ("GL Driver Message", "Failed to load resource", "GPU stall")


@dataclass
class Person:
    """Somebody at the page in a browser of their own. Counts what they do with their hands."""

    page: Page
    context: BrowserContext
    address: str
    stays: bool = False
    """whether the window is open from test to test"""
    loaded_after: int | None = None
    """how many tests had failed when the page was loaded in a window that stays"""
    inputs: int = 0
    complaints: list[str] = field(default_factory=list)
    """what the browser or the service found wrong"""

    def open(self, place: str = "") -> None:
        """Opens the page; `place` is what follows the `#`."""
        self.page.goto(f"{self.address}{'#' + place if place else ''}")

    def go(self, place: str) -> None:
        """Goes from what is open to another place, and the page is not loaded anew."""
        self.ask("place => { location.hash = place }", place)

    def click(self, target: Any, **options: Any) -> None:
        """A click on what is named: a locator, or a point of the page."""
        self.inputs += 1
        if isinstance(target, tuple):
            self.page.mouse.click(*target, **options)
        else:
            target.click(timeout=PATIENCE_S * 1000, **options)

    def key(self, *keys: str) -> None:
        """One key after the other; a chord such as `Alt+ArrowUp` is one input."""
        for key in keys:
            self.inputs += 1
            self.page.keyboard.press(key)

    def type(self, text: str) -> None:
        """A text, of which each character is an input."""
        self.inputs += len(text)
        self.page.keyboard.type(text)

    def button(self, name: str, exact: bool = True) -> Any:
        return self.page.get_by_role("button", name=name, exact=exact).first

    def focus(self, what: Any) -> None:
        """Puts the focus on something, once it can have it."""
        expect(what).to_be_enabled()
        what.focus()
        expect(what).to_be_focused()

    @property
    def saved(self) -> Any:
        """Where the page says whether all is saved."""
        return self.page.locator("argo-topbar [role=status]")

    def ask(self, expression: str, argument: Any = None) -> Any:
        """What an expression of the page says."""
        return self.page.evaluate(expression, argument)

    def until(self, what: Callable[[], Any], said: str) -> Any:
        """Waits until something is so."""
        end = time.monotonic() + PATIENCE_S
        while not (found := what()):
            if time.monotonic() > end:
                pytest.fail(f"not in {PATIENCE_S} s: {said}")
            self.page.wait_for_timeout(20)
        return found

    def idle(self) -> None:
        """Waits until the scene has drawn all that there is."""
        self.until(lambda: self.ask("() => window.argo?.idle() ?? false"), "the scene is idle")

    def at(self, x: float, y: float, z: float) -> tuple[float, float]:
        """Where a point of the site is in the window."""
        found = self.ask("p => window.argo.project(...p)", [x, y, z])
        return found["x"], found["y"]

    def heard(self, message: ConsoleMessage) -> None:
        if message.type in ("error", "warning") and not any(n in message.text for n in _NOT_OURS):
            self.complaints.append(f"console: {message.text}")

    def asked(self, request: Request) -> None:
        host = urlsplit(request.url)
        if host.scheme in ("http", "https") and host.netloc != urlsplit(self.address).netloc:
            self.complaints.append(f"another host was asked: {request.url}")


class Browsers:
    """Chromium, and the people who use it."""

    def __init__(self, scale: float = 1.0, scene: float | None = None) -> None:
        """`scale`: px that are drawn for one of the page, `scene`: for one of the picture of the
        site (None: as the page has it)."""
        self._scale = scale
        self._scene = scene
        self._playwright = sync_playwright().start()
        self._browser: Browser = self._playwright.chromium.launch(
            executable_path=CHROMIUM, args=_OPTIONS
        )
        self.people: list[Person] = []

    def person(
        self, address: str, name: str = "ann", stays: bool = False, **context: Any
    ) -> Person:
        """Somebody new, who has not opened the page yet."""
        options: dict[str, Any] = {
            "viewport": {"width": 1400, "height": 850},
            "locale": "en-GB",
            "device_scale_factor": self._scale,
        }
        options |= context
        opened = self._browser.new_context(**options)
        kept = (
            f"localStorage.getItem('argo.author') ?? localStorage.setItem('argo.author', '{name}')"
        )
        opened.add_init_script(kept)
        if self._scene is not None:
            told = f"Object.defineProperty(window, 'devicePixelRatio', {{ value: {self._scene} }})"
            opened.add_init_script(told)
        page = opened.new_page()
        page.set_default_timeout(PATIENCE_S * 1000)
        person = Person(page, opened, address, stays)
        page.on("console", person.heard)
        page.on("pageerror", lambda error: person.complaints.append(f"error: {error}"))
        page.on("request", person.asked)
        page.on(
            "response",
            lambda r: r.status >= 500 and person.complaints.append(f"{r.status}: {r.url}"),
        )
        self.people.append(person)
        return person

    def leave(self) -> None:
        """All but those who stay close their windows. What was complained of fails the test."""
        complaints = [said for person in self.people for said in person.complaints]
        for person in self.people:
            person.complaints.clear()
            if not person.stays:
                person.context.close()
        self.people = [person for person in self.people if person.stays]
        assert complaints == []

    def close(self) -> None:
        self._browser.close()
        self._playwright.stop()


class Line:
    """A connection to a service that can be cut: a port of its own, behind which it is."""

    def __init__(self, address: str) -> None:
        host, _, port = address.rpartition(":")
        self._service = host, int(port)
        self._listening = socket.create_server(("127.0.0.1", 0))
        self.address = f"127.0.0.1:{self._listening.getsockname()[1]}"
        self._open: set[socket.socket] = set()
        self._whole = threading.Event()
        self._whole.set()
        threading.Thread(target=self._serve, daemon=True).start()

    def __enter__(self) -> "Line":
        return self

    def __exit__(self, *_: object) -> None:
        self._listening.close()
        self.cut()

    def cut(self) -> None:
        """All connections break, and no other is had."""
        self._whole.clear()
        for one in list(self._open):
            with suppress(OSError):
                one.shutdown(socket.SHUT_RDWR)
            one.close()
        self._open.clear()

    def mend(self) -> None:
        self._whole.set()

    def _serve(self) -> None:
        while True:
            try:
                near, _ = self._listening.accept()
            except OSError:
                return
            if not self._whole.is_set():
                near.close()
                continue
            far = socket.create_connection(self._service)
            self._open |= {near, far}
            for source, sink in ((near, far), (far, near)):
                threading.Thread(target=self._carry, args=(source, sink), daemon=True).start()

    @staticmethod
    def _carry(source: socket.socket, sink: socket.socket) -> None:
        with suppress(OSError):
            while content := source.recv(65536):
                sink.sendall(content)
        with suppress(OSError):
            sink.shutdown(socket.SHUT_WR)
