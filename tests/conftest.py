"""What the whole suite shares. Import it as `from tests.conftest import examples`."""

import atexit
import os
import shutil
import tempfile
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings
from hypothesis.internal.conjecture import providers
from xdist.remote import Producer
from xdist.scheduler import LoadFileScheduling

# As many workers run as there are cores: threads of numerical libraries would wait for each other.
os.environ |= {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}

EXAMPLES = os.environ.get("ARGO_EXAMPLES")

# How long an example takes depends on what else the machine does: no answer may depend on that.
_UNTIMED = settings(deadline=None, database=None, suppress_health_check=[HealthCheck.too_slow])
settings.register_profile("suite", _UNTIMED, derandomize=True)
settings.register_profile("campaign", _UNTIMED, print_blob=True)
settings.load_profile("campaign" if EXAMPLES else "suite")

if not EXAMPLES:
    # Hypothesis also draws numbers and words that it finds in the modules loaded so far, and which
    # these are depends on the tests that ran before in the same process.
    assert providers._get_local_constants
    providers._get_local_constants = lambda: providers._local_constants

if "ARGO_CACHE_DIR" not in os.environ:
    # Of this run, for all of its processes: they inherit it from the first one.
    os.environ["ARGO_CACHE_DIR"] = tempfile.mkdtemp(prefix="argo-cache-")
    atexit.register(shutil.rmtree, os.environ["ARGO_CACHE_DIR"], ignore_errors=True)


def examples(suite: int) -> int:
    """How many random examples to try: `suite`, or what ARGO_EXAMPLES says for a campaign.

    The suite tries the same ones each time, a campaign others each time.
    """
    return int(EXAMPLES or suite)


_ORDER = ("e2e", "argo_env", "baselines")
"""The folders whose files take longest come first, so that no worker waits for another's last."""


_SHARED = {
    "tests/argo_env/planning/test_travel.py": "missions on UMAD",
    "tests/argo_env/run/test_runner.py": "missions on UMAD",
    "tests/argo_env/drives/tracked/test_body.py": "the tracked drive's world",
    "tests/argo_env/drives/tracked/test_drive.py": "the tracked drive's world",
}
"""Files that share a fixture that takes long, and what it is."""


def work_unit(test: str) -> str:
    """What one worker runs of all that the test belongs to: its file, in its order.

    So fixtures are made once, and what one test leaves behind is left to the same others each time.
    """
    file = test.split("::", 1)[0]
    return _SHARED.get(file, file)


class _ByFile(LoadFileScheduling):
    def _split_scope(self, nodeid: str) -> str:
        return work_unit(nodeid)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Producer) -> LoadFileScheduling:
    return _ByFile(config, log)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Brings what takes longest to the front."""
    root = Path(__file__).parent

    def place(item: pytest.Item) -> int:
        folder = item.path.relative_to(root).parts[0]
        return _ORDER.index(folder) if folder in _ORDER else len(_ORDER)

    items.sort(key=place)
