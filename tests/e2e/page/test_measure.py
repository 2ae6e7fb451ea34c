"""The measurements of the page in their smallest size."""

import pytest

from argo_planner.service.web.page import page_folder
from tests.e2e.page import measure
from tests.e2e.page.person import CHROMIUM, NO_CHROMIUM


@pytest.mark.long
def test_what_is_printed(capfd):
    if CHROMIUM is None:
        pytest.skip(NO_CHROMIUM)
    if not (page_folder() / "index.html").is_file():
        pytest.skip("the page is not built: `make page` builds it")
    measure.main(["--large", "umad", "--tasks", "3", "--pages", "2"])
    said = capfd.readouterr().out  # of a process of its own as well
    for figure in ("verdict p95", "3 tasks, again: usable in", "times all of the", "2 pages with"):
        assert figure in said
