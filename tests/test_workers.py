"""Distribution of tests to workers, which decides the suite's speed and order."""

import os
from collections import defaultdict

import pytest

from tests.conftest import _SHARED, work_unit
from tests.processes import ROOT, run_python

CONFTEST = """
from tests import conftest
from tests.conftest import pytest_xdist_make_scheduler
conftest._SHARED |= {"test_a.py": "what is shared", "test_c.py": "what is shared"}
"""
TESTS = """
import os, time, pytest
@pytest.mark.parametrize("k", range(4))
def test(k):
    with open("ran", "a") as file:
        print(__name__, os.environ["PYTEST_XDIST_WORKER"], k, file=file)
    time.sleep(0.05)
"""


def test_files_that_share_something_are_there():
    assert all((ROOT / file).is_file() for file in _SHARED)
    assert work_unit("tests/a.py::TestB::test_c[d::e]") == "tests/a.py"


@pytest.mark.long
def test_one_worker_runs_a_file_and_those_that_share_something_with_it(tmp_path):
    (tmp_path / "conftest.py").write_text(CONFTEST, encoding="utf-8")
    for name in "abcd":
        (tmp_path / f"test_{name}.py").write_text(TESTS, encoding="utf-8")
    options = ("-n2", "--dist=loadfile", "-c", os.devnull, "--rootdir=.")
    run_python("-m", "pytest", *options, cwd=tmp_path, env=os.environ | {"PYTHONPATH": str(ROOT)})
    ran = defaultdict(list)
    for line in (tmp_path / "ran").read_text(encoding="utf-8").splitlines():
        file, worker, k = line.split()
        ran[file].append((worker, int(k)))
    workers = {file: {worker for worker, _ in tests} for file, tests in ran.items()}
    assert [k for tests in ran.values() for _, k in tests] == [0, 1, 2, 3] * 4
    assert all(len(one) == 1 for one in workers.values())
    assert workers["test_a"] == workers["test_c"]
    assert len(set.union(*workers.values())) == 2
