"""Fixtures of the tests of the page: a service with the built page, and browsers."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import expect

from argo_env.planning.opening import OpenedSite, open_site
from argo_planner.service.web.page import page_folder_path
from tests.argo_planner.service.served import ALL, Served, served
from tests.e2e.page.person import CHROMIUM, NO_CHROMIUM, Browsers, Person


@pytest.fixture(scope="session")
def umad() -> OpenedSite:
    return open_site("umad").prepare()


@pytest.fixture(scope="module")
def service(tmp_path_factory, umad) -> Iterator[Served]:
    """Yield a service that all tests of a file share."""
    if not (page_folder_path() / "index.html").is_file():
        pytest.skip("the page is not built: `make page` builds it")
    with served(tmp_path_factory.mktemp("missions"), umad) as running:
        yield running


@pytest.fixture(scope="module")
def chromium() -> Iterator[Browsers]:
    if CHROMIUM is None:
        pytest.skip(NO_CHROMIUM)
    # Pixels are drawn in software, which takes most of the time, so there are few. The picture of
    # the site has even fewer: no test looks at it, and clicks in it do not depend on them.
    browsers = Browsers(scale=0.5, scene=0.1)
    yield browsers
    browsers.close()


@pytest.fixture
def browsers(chromium: Browsers) -> Iterator[Browsers]:
    """Yield browsers; after the test, close their windows and fail if there were problems."""
    yield chromium
    chromium.close_windows()


@pytest.fixture(scope="module")
def address(service: Served) -> str:
    """Return the address of the page, with the token."""
    return f"http://{service.address}/?token={ALL}"


@pytest.fixture
def ann(browsers: Browsers, address: str) -> Person:
    """Return a person at the list of missions, in a window of their own."""
    ann = browsers.person(address)
    ann.open()
    expect(ann.button("New mission")).to_be_enabled()
    return ann


@pytest.fixture(scope="module")
def window(chromium: Browsers, address: str) -> Person:
    """Return a person whose window stays open for all tests of a file."""
    return chromium.person(address, stays=True)


@pytest.fixture
def shared_person(browsers: Browsers, window: Person, request: pytest.FixtureRequest) -> Person:  # noqa: ARG001
    """Return a person at the list of missions in the window that all tests of a file share.

    The page is loaded once, and again after a test that failed. When it leaves a mission, it
    forgets the mission's view, selection and tool.
    """
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
