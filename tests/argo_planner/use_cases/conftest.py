import pytest

from argo_env.planning.opening import OpenedSite
from tests.yard import yard


@pytest.fixture(scope="package")
def site() -> OpenedSite:
    return OpenedSite.of(yard().site)


@pytest.fixture(autouse=True)
def nothing_is_printed(capfd: pytest.CaptureFixture[str]):
    """Neither by Python nor by a library below it."""
    yield
    assert capfd.readouterr() == ("", "")
