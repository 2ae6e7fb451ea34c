"""Service and OpenAPI document agree, for requests of all kinds."""

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

from argo_planner.service.web.app import openapi_document
from tests.argo_planner.service.served import ALL, Served
from tests.conftest import EXAMPLES, FIRST_SEED, examples, sample

DOCUMENT = Path(__file__).parents[3] / "docs" / "openapi.json"

# A body that matches its schema may still be invalid, such as a script. A deleted mission exists
# again after it is restored from the bin.
EXCLUDED_CHECKS = "positive_data_acceptance,use_after_free"


def test_the_stored_document_is_up_to_date() -> None:
    """`make generated` writes it again; a review thus shows each change."""
    assert DOCUMENT.read_text(encoding="utf-8") == openapi_document()


def test_the_document_is_served(service: Served) -> None:
    served = service.client.get("/api/openapi.json")
    assert served.json()["paths"].keys() >= {"/api/missions/{id}/commands"}


def run_schemathesis(service: Served, folder: Path, *options: str) -> int:
    """Test the service with schemathesis, and return the number of its cases."""
    answer = subprocess.run(
        [
            Path(sys.executable).with_name("schemathesis"),
            "run",
            f"http://{service.address}/api/openapi.json",
            *("-H", f"Authorization: Bearer {ALL}"),
            *("--seed", str(1 + FIRST_SEED), "--no-color", "--generation-database", "none"),
            *("--exclude-checks", EXCLUDED_CHECKS, *options),
        ],
        capture_output=True,
        text=True,
        check=False,
        cwd=folder,  # schemathesis writes files there
    )
    assert answer.returncode == 0, answer.stdout[-20_000:] + answer.stderr[-2_000:]
    match = re.search(r"(\d+) generated", answer.stdout)
    assert match, answer.stdout[-2_000:]
    return int(match[1])


@pytest.mark.long
def test_cases_with_links_are_answered_as_documented(service: Served, tmp_path: Path) -> None:
    """Parameters have values at and beyond their limits, at random, or from other answers."""
    # The first import loads what all need; schemathesis waits 10 s for an answer.
    service.client.post("/api/imports?filename=a.txt", content="Check valve R7.")
    paths = json.loads(DOCUMENT.read_text(encoding="utf-8"))["paths"].values()
    ids = sorted(one["operationId"] for methods in paths for one in methods.values())
    options = [word for id in sample(ids) for word in ("--include-operation-id", id)]
    at_limits = run_schemathesis(service, tmp_path, "--phases", "coverage", *options)
    count = 10 if EXAMPLES is None else examples(100)
    random = ("--phases", "fuzzing,stateful", "-n", str(count))
    assert at_limits + run_schemathesis(service, tmp_path, *random) >= 100 * count
