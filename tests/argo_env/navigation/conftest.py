import pytest

from argo_env.navigation import Navigator
from argo_env.site import load_site


@pytest.fixture(scope="session")
def hall(robot):
    """The navigator of the small test site: two floors, one flight."""
    return Navigator(load_site("darmstadt"), robot)
