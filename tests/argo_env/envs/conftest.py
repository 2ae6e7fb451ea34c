"""What the tests of environments share: UMAD as the environments keep it, a small yard, the ids of
all environments, and what makes them and closes those that a test has made."""

from contextlib import ExitStack

import gymnasium as gym
import pytest

from argo_env.envs import ENVIRONMENTS
from argo_env.planning import open_site
from tests.yard import AWAY_FROM_THE_EDGE, write_site


@pytest.fixture(scope="session")
def navigator():
    """That of UMAD, as the environments keep it."""
    return open_site("umad").prepare().navigator


@pytest.fixture(scope="session")
def yard_file(tmp_path_factory):
    """A site on one level, for what does not depend on the site."""
    return write_site(tmp_path_factory.mktemp("yard") / "site.yaml", areas=AWAY_FROM_THE_EDGE)


@pytest.fixture(params=sorted(ENVIRONMENTS))
def id(request):
    return request.param


@pytest.fixture
def small(id, yard_file):
    """The arguments with which an environment has a small site, where it has one."""
    return {} if id == "argo/Route-v0" else {"scenario": yard_file}


@pytest.fixture
def closing():
    """Closes what it is given when the test has ended."""
    with ExitStack() as stack:

        def one(env):
            stack.callback(env.close)
            return env

        yield one


@pytest.fixture
def make(id, small, closing):
    """Makes environments of one kind, without wrappers, and closes them."""

    def one(**arguments):
        return closing(gym.make(id, disable_env_checker=True, **small | arguments)).unwrapped

    return one
