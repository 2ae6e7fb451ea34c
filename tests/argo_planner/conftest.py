import pytest

from argo_compiler.catalog import Catalog
from argo_env.navigation import Navigator
from argo_env.planning.opening import OpenedSite, open_site


@pytest.fixture(scope="session")
def umad() -> OpenedSite:
    return open_site("umad")


@pytest.fixture(scope="session")
def navigator(umad: OpenedSite) -> Navigator:
    return umad.navigator


@pytest.fixture(scope="session")
def catalog(umad: OpenedSite) -> Catalog:
    return umad.catalog
