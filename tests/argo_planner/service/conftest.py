"""Fixtures for tests of the service."""

import pytest

from argo_env.planning.opening import OpenedSite, open_site
from argo_planner.service.processes.context import CONTEXT
from tests.argo_planner.service.served import Served, served


@pytest.fixture(scope="session", autouse=True)
def loaded() -> None:
    """Let the service fork its processes from one that has loaded all their modules."""
    CONTEXT.set_forkserver_preload(["tests.argo_planner.service.loaded"])


@pytest.fixture(scope="session")
def site() -> OpenedSite:
    return open_site("umad").prepare()


@pytest.fixture(scope="module")
def service(tmp_path_factory, site) -> Served:
    """Service that all tests of a file use."""
    with served(tmp_path_factory.mktemp("missions"), site) as running:
        yield running
