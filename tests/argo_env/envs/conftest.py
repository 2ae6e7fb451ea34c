"""The sites of the environments' tests: UMAD as the environments keep it, and a small yard."""

import pytest
import yaml

from argo_env.planning import open_site
from tests.yard import SITE


@pytest.fixture(scope="session")
def navigator():
    return open_site("umad").prepare().navigator


@pytest.fixture(scope="session")
def yard_file(tmp_path_factory):
    """A site on one level, for what does not depend on the site."""
    path = tmp_path_factory.mktemp("yard") / "site.yaml"
    # Away from the edge, so that it turns in its dock.
    site = SITE | {"areas": [{"number": 1, "dock": [2.05, 2.05, 0]}]}
    path.write_text(yaml.safe_dump(site), encoding="utf-8")
    return str(path)
