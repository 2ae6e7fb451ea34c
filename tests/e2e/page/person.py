"""People at the page: real browsers, whose inputs are counted, and connections that can be cut."""

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
"""s after which a wait fails: far more than anything takes, also on a busy machine"""
expect.set_options(timeout=1000 * PATIENCE_S)

# Messages of the browser's software renderer, and of refused requests, which the page itself shows.
_IGNORED_MESSAGES = ("GL Driver Message", "Failed to load resource", "GPU stall")


@dataclass
class Person:
    """Person at the page in a browser context of their own. Counts key presses and clicks."""

    page: Page
    context: BrowserContext
    address: str
    stays: bool = False
    """True if the window stays open from test to test"""
    loaded_after: int | None = None
    """number of failed tests when the page was loaded; None: not loaded in a window that stays"""
    inputs: int = 0
    problems: list[str] = field(default_factory=list)
    """errors of the page and the service, warnings of the browser, requests to other hosts"""

    def open(self, fragment: str = "") -> None:
        """Load the page, with the address's fragment (what follows the `#`)."""
        self.page.goto(f"{self.address}{'#' + fragment if fragment else ''}")

    def go(self, fragment: str) -> None:
        """Change the address's fragment without loading the page again."""
        self.evaluate("fragment => { location.hash = fragment }", fragment)

    def click(self, target: Any, **options: Any) -> None:
        """Click on a locator or on a point of the page (x, y in px)."""
        self.inputs += 1
        if isinstance(target, tuple):
            self.page.mouse.click(*target, **options)
        else:
            target.click(timeout=PATIENCE_S * 1000, **options)

    def key(self, *keys: str) -> None:
        """Press keys one after the other; a chord such as `Alt+ArrowUp` counts as one input."""
        for key in keys:
            self.inputs += 1
            self.page.keyboard.press(key)

    def type(self, text: str) -> None:
        """Type a text; each character counts as an input."""
        self.inputs += len(text)
        self.page.keyboard.type(text)

    def button(self, name: str, exact: bool = True) -> Any:
        return self.page.get_by_role("button", name=name, exact=exact).first

    def focus(self, target: Any) -> None:
        """Focus a locator once it is enabled."""
        expect(target).to_be_enabled()
        target.focus()
        expect(target).to_be_focused()

    def focused(self) -> str:
        """Return the label or the text of the focused element; empty: nothing has the focus."""
        return str(
            self.evaluate(
                """() => {
                    let at = document.activeElement;
                    while (at?.shadowRoot?.activeElement) at = at.shadowRoot.activeElement;
                    if (at === null || at === document.body) return "";
                    const label = at.labels?.[0]?.innerText ?? at.getAttribute("aria-label");
                    return (label ?? at.innerText).trim();
                }"""
            )
        )

    @property
    def save_status(self) -> Any:
        """Locator of the text that states if all edits are saved."""
        return self.page.locator("argo-topbar [role=status]")

    def evaluate(self, expression: str, argument: Any = None) -> Any:
        """Evaluate a JavaScript expression in the page and return its value."""
        return self.page.evaluate(expression, argument)

    def wait_until(self, condition: Callable[[], Any], description: str) -> Any:
        """Wait until a condition is true and return its value; fail after PATIENCE_S."""
        end = time.monotonic() + PATIENCE_S
        while not (result := condition()):
            if time.monotonic() > end:
                pytest.fail(f"not within {PATIENCE_S} s: {description}")
            self.page.wait_for_timeout(20)
        return result

    def wait_for_scene(self) -> None:
        """Wait until the scene has drawn everything."""
        self.wait_until(
            lambda: self.evaluate("() => window.argo?.idle() ?? false"), "the scene is idle"
        )

    def project(self, x: float, y: float, z: float) -> tuple[float, float]:
        """Return where a point of the site (m) appears in the window (px)."""
        point = self.evaluate("p => window.argo.project(...p)", [x, y, z])
        return point["x"], point["y"]

    def on_console(self, message: ConsoleMessage) -> None:
        if message.type in ("error", "warning") and not any(
            n in message.text for n in _IGNORED_MESSAGES
        ):
            self.problems.append(f"console: {message.text}")

    def clear_connection_problems(self) -> None:
        """Clear the browser's own messages of connections and requests that a proxy has cut."""
        self.problems[:] = [
            problem
            for problem in self.problems
            if "WebSocket connection" not in problem and "net::ERR_" not in problem
        ]

    def on_request(self, request: Request) -> None:
        host = urlsplit(request.url)
        if host.scheme in ("http", "https") and host.netloc != urlsplit(self.address).netloc:
            self.problems.append(f"request to another host: {request.url}")


class Browsers:
    """Chromium, with the people who use it."""

    def __init__(self, scale: float = 1.0, scene: float | None = None) -> None:
        """Start Chromium.

        Args:
            scale: Pixels drawn for one px of the page.
            scene: Pixels drawn for one px of the site's picture; None: as for the page.
        """
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
        """Return a new person, who has not opened the page yet."""
        options: dict[str, Any] = {
            "viewport": {"width": 1400, "height": 850},
            "locale": "en-GB",
            "device_scale_factor": self._scale,
        }
        options |= context
        opened = self._browser.new_context(**options)
        set_author = (
            f"localStorage.getItem('argo.author') ?? localStorage.setItem('argo.author', '{name}')"
        )
        opened.add_init_script(set_author)
        if self._scene is not None:
            set_ratio = (
                f"Object.defineProperty(window, 'devicePixelRatio', {{ value: {self._scene} }})"
            )
            opened.add_init_script(set_ratio)
        page = opened.new_page()
        page.set_default_timeout(PATIENCE_S * 1000)
        person = Person(page, opened, address, stays)
        page.on("console", person.on_console)
        page.on("pageerror", lambda error: person.problems.append(f"error: {error}"))
        page.on("request", person.on_request)
        page.on(
            "response",
            lambda r: r.status >= 500 and person.problems.append(f"{r.status}: {r.url}"),
        )
        self.people.append(person)
        return person

    def close_windows(self) -> None:
        """Close the windows that do not stay; fail if anyone had problems."""
        problems = [problem for person in self.people for problem in person.problems]
        for person in self.people:
            person.problems.clear()
            if not person.stays:
                person.context.close()
        self.people = [person for person in self.people if person.stays]
        assert not problems, "\n".join(problems)

    def close(self) -> None:
        self._browser.close()
        self._playwright.stop()


class Proxy:
    """Proxy of a service whose connections can be cut; it has a port of its own."""

    def __init__(self, address: str) -> None:
        host, _, port = address.rpartition(":")
        self._service = host, int(port)
        self._listening = socket.create_server(("127.0.0.1", 0))
        self.address = f"127.0.0.1:{self._listening.getsockname()[1]}"
        self._open: set[socket.socket] = set()
        self._connected = threading.Event()
        self._connected.set()
        threading.Thread(target=self._serve, daemon=True).start()

    def __enter__(self) -> "Proxy":
        return self

    def __exit__(self, *_: object) -> None:
        self._listening.close()
        self.cut()

    def cut(self) -> None:
        """Break all connections and refuse new ones until `restore`."""
        self._connected.clear()
        for one in list(self._open):
            with suppress(OSError):
                one.shutdown(socket.SHUT_RDWR)
            one.close()
        self._open.clear()

    def restore(self) -> None:
        self._connected.set()

    def _serve(self) -> None:
        while True:
            try:
                near, _ = self._listening.accept()
            except OSError:
                return
            if not self._connected.is_set():
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
