"""Fixtures of the tests of environments: UMAD, a small yard, all ids, and closed environments."""

from contextlib import ExitStack

import gymnasium as gym
import pytest

from argo_env.envs import ENVIRONMENTS
from argo_env.planning import open_site
from tests.yard import AWAY_FROM_THE_EDGE, write_site


@pytest.fixture(scope="session")
def navigator():
    """Return the navigator of UMAD that the environments cache."""
    return open_site("umad").prepare().navigator


@pytest.fixture(scope="session")
def yard_file(tmp_path_factory):
    """Return the file of a site on one level, for tests that do not depend on the site."""
    return write_site(tmp_path_factory.mktemp("yard") / "site.yaml", areas=AWAY_FROM_THE_EDGE)


@pytest.fixture(params=sorted(ENVIRONMENTS))
def id(request):
    return request.param


@pytest.fixture
def small(id, yard_file):
    """Return the arguments with which an environment has a small site, if it has one."""
    return {} if id == "argo/Route-v0" else {"scenario": yard_file}


@pytest.fixture
def closing():
    """Yield a function that returns an environment and closes it after the test."""
    with ExitStack() as stack:

        def one(env):
            stack.callback(env.close)
            return env

        yield one


@pytest.fixture
def make(id, small, closing):
    """Return a function that makes environments without wrappers, closed after the test."""

    def one(**arguments):
        return closing(gym.make(id, disable_env_checker=True, **small | arguments)).unwrapped

    return one
