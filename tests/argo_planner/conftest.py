import pytest
from click.testing import Result
from typer.testing import CliRunner

from argo_compiler.base.catalog import Catalog
from argo_env.navigation import Navigator
from argo_env.planning.opening import OpenedSite, open_site
from argo_planner.cli import app
from argo_planner.terminal import stage_display
from tests import yard


def argo(*words: object, status: int | None = None) -> Result:
    """Run the command in this process; assert its exit status if one is given."""
    result = CliRunner().invoke(app, [*map(str, words)])
    assert status in (None, result.exit_code), f"{result.output}{result.exception}"
    return result


@pytest.fixture(autouse=True)
def no_stages(monkeypatch: pytest.MonkeyPatch) -> None:
    """Show no stages, which a slow machine would show at random."""
    monkeypatch.setattr(stage_display, "AFTER", float("inf"))


@pytest.fixture
def quick_picture(monkeypatch: pytest.MonkeyPatch) -> None:
    """Replace the picture of the site in a report, which takes long to draw."""
    monkeypatch.setattr(
        "argo_planner.use_cases.reporting.write_overview",
        lambda *given: given[-1].write_bytes(b"a picture"),
    )


@pytest.fixture(scope="session")
def umad() -> OpenedSite:
    return open_site("umad")


@pytest.fixture(scope="session")
def yard_site() -> OpenedSite:
    """Return the opened yard."""
    return yard.opened(yard.yard())


@pytest.fixture(scope="session")
def navigator(umad: OpenedSite) -> Navigator:
    return umad.navigator


@pytest.fixture(scope="session")
def catalog(umad: OpenedSite) -> Catalog:
    return umad.catalog


@pytest.fixture(scope="session")
def anyio_backend() -> str:
    """Return the name of the library that runs tests that are coroutines (marked `anyio`)."""
    return "asyncio"
