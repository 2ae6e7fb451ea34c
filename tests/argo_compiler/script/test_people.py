"""Scripts as people write them: each becomes what a careful reader takes it for, or is asked
about at its place; none becomes something else without a word."""

import os
from collections import Counter
from pathlib import Path

import pytest

from argo_env.navigation import Navigator
from argo_env.planning.catalog import make_catalog
from argo_env.robot.spec import load_robot
from argo_env.site import load_site
from tests.argo_compiler.script.judging.verdicts import Kind, judge, load

OURS = Path(__file__).parent / "people"
RIGHT_SHARE = 0.95


@pytest.fixture(scope="module")
def site():
    return make_catalog(Navigator(load_site("umad"), load_robot()))


def require_good(folder, catalog):
    results = [judge(case, catalog) for case in load(folder)]
    assert results, f"{folder} has no scripts"
    kinds = Counter(result.kind for result in results)
    wrong = [result for result in results if result.kind is not Kind.RIGHT]
    said = "\n".join(f"{r.name}: {r.kind}: {r.why}" for r in wrong)
    assert not kinds[Kind.SILENT], said
    assert kinds[Kind.RIGHT] >= RIGHT_SHARE * len(results), said


def test_scripts_of_people(site):
    require_good(OURS, site)


def test_scripts_of_other_people(site):
    folder = os.environ.get("ARGO_CORPUS")
    if not folder:
        pytest.skip("ARGO_CORPUS names no folder: no other people's scripts are tried")
    require_good(Path(folder), site)
