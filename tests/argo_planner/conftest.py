import pytest

from argo_compiler.catalog import Catalog
from argo_env.navigation import Navigator
from argo_env.planning import open_site
from argo_env.planning.catalog import make_catalog


@pytest.fixture(scope="session")
def navigator() -> Navigator:
    return open_site("umad").navigator


@pytest.fixture(scope="session")
def catalog(navigator: Navigator) -> Catalog:
    return make_catalog(navigator)
