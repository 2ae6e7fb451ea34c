import pytest

from argo_compiler.catalog import Catalog
from argo_env.navigation import Navigator
from argo_env.planning.catalog import make_catalog
from argo_planner.loading import load_navigator


@pytest.fixture(scope="session")
def navigator() -> Navigator:
    return load_navigator("umad")


@pytest.fixture(scope="session")
def catalog(navigator: Navigator) -> Catalog:
    return make_catalog(navigator)
