"""The measurements of the page in their smallest size."""

import pytest

from tests.e2e.page import measure
from tests.e2e.page.person import CHROMIUM, NO_CHROMIUM


@pytest.mark.long
@pytest.mark.usefixtures("service")  # skips where the page is not built
def test_the_measurements_are_printed(capfd):
    if CHROMIUM is None:
        pytest.skip(NO_CHROMIUM)
    measure.main(["--large", "umad", "--moves", "10", "--tasks", "3", "--pages", "2"])
    output = capfd.readouterr().out  # also that of the child process
    for figure in ("verdict p95", "3 tasks, again: usable in", "times all of the", "2 pages with"):
        assert figure in output
