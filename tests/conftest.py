"""Set-up and helpers of the whole suite. Import them as `from tests.conftest import examples`."""

import atexit
import gc
import json
import os
import random
import shutil
import tempfile
from collections import defaultdict
from collections.abc import Iterable
from itertools import islice
from pathlib import Path
from typing import TypeVar

import pytest
from hypothesis import HealthCheck, settings
from hypothesis.internal.conjecture import providers
from xdist.remote import Producer
from xdist.scheduler import LoadFileScheduling

# More workers run than there are cores: threads of numerical libraries would wait for each other,
# and so would worker processes, each of which takes seconds to begin.
os.environ |= {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "PYTHON_CPU_COUNT": "1"}

_T = TypeVar("_T")

EXAMPLES = os.environ.get("ARGO_EXAMPLES")
"""Unset for the suite, `full` for all campaigns, a number for the campaign of one property."""

# How long an example takes depends on what else the machine does: no answer may depend on that.
_UNTIMED = settings(deadline=None, database=None, suppress_health_check=[HealthCheck.too_slow])
settings.register_profile("suite", _UNTIMED, derandomize=True)
settings.register_profile("campaign", _UNTIMED, print_blob=True)
settings.load_profile("campaign" if EXAMPLES else "suite")

if EXAMPLES:
    os.environ.setdefault("PYTEST_TIMEOUT", "0")  # none: a campaign takes hours
    os.environ.setdefault("ARGO_FIRST_SEED", str(random.randrange(1_000_000)))
FIRST_SEED = int(os.environ.get("ARGO_FIRST_SEED", "0"))
"""The first seed of generators: 0 in the suite, and another one in each campaign. The workers of a
run inherit it from the process that starts them."""

if not EXAMPLES:
    # Hypothesis also draws numbers and words that it finds in the modules loaded so far, and which
    # these are depends on the tests that ran before in the same process.
    assert providers._get_local_constants
    providers._get_local_constants = lambda: providers._local_constants

if "ARGO_CACHE_DIR" not in os.environ:
    # Of this run, for all of its processes: they inherit it from the first one.
    os.environ["ARGO_CACHE_DIR"] = tempfile.mkdtemp(prefix="argo-cache-")
    atexit.register(shutil.rmtree, os.environ["ARGO_CACHE_DIR"], ignore_errors=True)


def examples(full: int) -> int:
    """Return the number of random examples, kills or other repetitions of a test.

    The suite makes a quarter of `full`, the same ones each time. `make test-campaigns` makes all
    of them, and a campaign of one property as many as ARGO_EXAMPLES states; both make different
    ones each time.
    """
    if EXAMPLES is None:
        return -(-full // 4)
    return full if EXAMPLES == "full" else int(EXAMPLES)


def seeds(full: int) -> range:
    """Return the seeds of `examples(full)` cases."""
    return range(FIRST_SEED, FIRST_SEED + examples(full))


def sample(items: Iterable[_T], each: int = 4) -> Iterable[_T]:
    """Return every `each`-th item in the suite, and all items in a campaign."""
    return islice(items, 0, None, None if EXAMPLES else each)


def pytest_report_header() -> str | None:
    return f"ARGO_FIRST_SEED={FIRST_SEED} draws the same" if EXAMPLES else None


_CLUSTERS = "a Ray and a Dask cluster"
_SOURCE = "the syntax trees of the source"
_SHARED = {
    "tests/argo_compiler/diagnostics/test_codes.py": _SOURCE,
    "tests/test_structure.py": _SOURCE,
    "tests/argo_env/planning/test_travel.py": "missions on UMAD",
    "tests/argo_env/run/test_runner.py": "missions on UMAD",
    "tests/argo_env/drives/tracked/test_body.py": "the tracked drive's world",
    "tests/argo_env/drives/tracked/test_drive.py": "the tracked drive's world",
    "tests/argo_env/evaluation/pool/test_pool.py": _CLUSTERS,
    "tests/argo_env/evaluation/test_runner.py": _CLUSTERS,
}
"""Names of what takes long to make and is shared by files (fixtures, computations), by file."""


def work_unit(test: str) -> str:
    """Return the name of a test's unit: the tests of a unit run in their order on one worker.

    A unit is a file, the files that share a fixture, or the tests of the page: only one browser
    runs at a time. So fixtures are made once, and side effects of a test meet the same other tests
    in each run.
    """
    file = test.split("::", 1)[0]
    return "the page" if file.startswith("tests/e2e/page/") else _SHARED.get(file, file)


class _ByUnit(LoadFileScheduling):
    def _split_scope(self, nodeid: str) -> str:
        return work_unit(nodeid)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Producer) -> LoadFileScheduling:
    return _ByUnit(config, log)


_PHYSICS_NAMES = {"argo/Drive-v0", "kinematic", "tracked"}
"""names of drives and environments that need physics"""


def pytest_itemcollected(item: pytest.Item) -> None:
    """Mark a test as one that needs physics if a parameter names a drive that does."""
    if isinstance(item, pytest.Function) and hasattr(item, "callspec"):
        texts = {value for value in item.callspec.params.values() if isinstance(value, str)}
        if texts & _PHYSICS_NAMES:
            item.add_marker("physics")


_DURATIONS = Path(__file__).with_name("durations.json")
"""Seconds that the tests of each unit took when they were last recorded: those of `make test`, and
those marked `long`."""


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--record-durations", action="store_true", help=f"write {_DURATIONS.name} anew"
    )


def pytest_collection_finish() -> None:
    """Exclude all present objects from garbage collection, which saves a tenth of the time."""
    gc.collect()
    gc.freeze()


@pytest.hookimpl(trylast=True)  # after tests were deselected
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Sort the units by time, longest first, so that no worker waits long for the last one."""
    recorded = json.loads(_DURATIONS.read_text(encoding="utf-8"))
    parts: dict[str, set[bool]] = defaultdict(set)
    for item in items:
        parts[work_unit(item.nodeid)].add("long" in item.keywords)

    def seconds(item: pytest.Item) -> float:
        unit = work_unit(item.nodeid)
        return sum(recorded.get(unit, (0, 0))[part] for part in parts[unit])

    items.sort(key=lambda item: (-seconds(item), work_unit(item.nodeid)))


class _DurationRecorder:
    """Plugin that adds up the durations of each unit's tests, and writes them at the end."""

    def __init__(self) -> None:
        self._seconds: dict[str, list[float]] = defaultdict(lambda: [0.0, 0.0])

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        self._seconds[work_unit(report.nodeid)]["long" in report.keywords] += report.duration

    def pytest_sessionfinish(self) -> None:
        rounded = {
            unit: [round(seconds) for seconds in pair]
            for unit, pair in sorted(self._seconds.items())
            if sum(pair) >= 2
        }
        lines = [f"  {json.dumps(unit)}: {json.dumps(pair)}" for unit, pair in rounded.items()]
        _DURATIONS.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")


def pytest_configure(config: pytest.Config) -> None:
    is_worker = hasattr(config, "workerinput")
    if config.getoption("--record-durations") and not is_worker:
        config.pluginmanager.register(_DurationRecorder())


@pytest.fixture(scope="session")
def fault_inputs() -> Path:
    """Return the folder of inputs on which an older Argo failed, which are not part of it."""
    folder = os.environ.get("ARGO_FAULTS")
    if not folder:
        pytest.skip("ARGO_FAULTS names no folder: the inputs on which Argo failed are not tried")
    return Path(folder)
