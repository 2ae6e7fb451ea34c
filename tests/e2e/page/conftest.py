"""What the tests of the page share: a service with the built page, and browsers."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import expect

from argo_env.planning.opening import OpenedSite, open_site
from argo_planner.service.web.page import page_folder
from tests.argo_planner.service.served import ALL, Served, served
from tests.e2e.page.person import CHROMIUM, NO_CHROMIUM, Browsers, Person


@pytest.fixture(scope="session")
def umad() -> OpenedSite:
    return open_site("umad").prepare()


@pytest.fixture(scope="module")
def service(tmp_path_factory, umad) -> Iterator[Served]:
    """One for all tests of a file."""
    if not (page_folder() / "index.html").is_file():
        pytest.skip("the page is not built: `make page` builds it")
    with served(tmp_path_factory.mktemp("missions"), umad) as found:
        yield found


@pytest.fixture(scope="module")
def chromium() -> Iterator[Browsers]:
    if CHROMIUM is None:
        pytest.skip(NO_CHROMIUM)
    # Few pixels: they are drawn in software, which takes most of the time. Of the picture of the
    # site, at which nobody looks, still fewer; what a click hits in it does not depend on that.
    found = Browsers(scale=0.5, scene=0.1)
    yield found
    found.close()


@pytest.fixture
def browsers(chromium: Browsers) -> Iterator[Browsers]:
    """Browsers in which nothing went wrong by the end of the test."""
    yield chromium
    chromium.leave()


@pytest.fixture(scope="module")
def address(service: Served) -> str:
    """Where the page is, with the token."""
    return f"http://{service.address}/?token={ALL}"


@pytest.fixture
def ann(browsers: Browsers, address: str) -> Person:
    """Return somebody at the list of missions, in a window of their own."""
    ann = browsers.person(address)
    ann.open()
    expect(ann.button("New mission")).to_be_enabled()
    return ann


@pytest.fixture(scope="module")
def window(chromium: Browsers, address: str) -> Person:
    """Somebody whose window stays open for all tests of a file."""
    return chromium.person(address, stays=True)


@pytest.fixture
def resident(browsers: Browsers, window: Person, request: pytest.FixtureRequest) -> Person:  # noqa: ARG001
    """Somebody at the list of missions. The page is loaded once for all tests of a file, and again
    after a test that failed; with a mission it forgets what was seen and in hand there."""
    failed = request.session.testsfailed
    if window.loaded_after is None:
        window.open()
    elif window.loaded_after != failed:
        window.page.reload()
    window.loaded_after = failed
    window.go("")
    expect(window.page.locator("argo-home button.main")).to_be_enabled()
    window.inputs = 0
    return window
