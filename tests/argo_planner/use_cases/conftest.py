import pytest

from argo_env.planning.opening import OpenedSite
from tests.yard import yard


@pytest.fixture(scope="package")
def site() -> OpenedSite:
    return OpenedSite.from_site(yard().site)


@pytest.fixture(autouse=True)
def nothing_is_printed(capfd: pytest.CaptureFixture[str]):
    """Assert that neither Python nor a library in C prints anything."""
    yield
    assert capfd.readouterr() == ("", "")
