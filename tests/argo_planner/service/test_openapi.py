"""The service does what its OpenAPI document says, whatever it is asked."""

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

from argo_planner.service.web.app import document
from tests.argo_planner.service.served import ALL, Served
from tests.conftest import FIRST_SEED, examples, sample

DOCUMENT = Path(__file__).parents[3] / "docs" / "openapi.json"

# What is valid by its form may still make no sense, such as a script; and what was deleted is
# there again once it is taken out of the bin.
LEFT_OUT = "positive_data_acceptance,use_after_free"


def test_the_document_is_the_one_that_is_kept() -> None:
    """`make generated` writes it anew; what changes is seen in review."""
    assert DOCUMENT.read_text(encoding="utf-8") == document()


def test_the_document_is_served(service: Served) -> None:
    served = service.client.get("/api/openapi.json")
    assert served.json()["paths"].keys() >= {"/api/missions/{id}/commands"}


def cases(service: Served, folder: Path, *options: str) -> int:
    """Let schemathesis ask the service; return how many cases it made."""
    answer = subprocess.run(
        [
            Path(sys.executable).with_name("schemathesis"),
            "run",
            f"http://{service.address}/api/openapi.json",
            *("-H", f"Authorization: Bearer {ALL}"),
            *("--seed", str(1 + FIRST_SEED), "--no-color", "--generation-database", "none"),
            *("--exclude-checks", LEFT_OUT, *options),
        ],
        capture_output=True,
        text=True,
        check=False,
        cwd=folder,  # it leaves files behind
    )
    assert answer.returncode == 0, answer.stdout[-20_000:] + answer.stderr[-2_000:]
    found = re.search(r"(\d+) generated", answer.stdout)
    assert found, answer.stdout[-2_000:]
    return int(found[1])


@pytest.mark.long
def test_cases_with_links_are_answered_as_documented(service: Served, tmp_path: Path) -> None:
    """Operations are asked with values at and beyond the limits of their parameters; and each of
    them at random, also with what another operation has answered."""
    paths = json.loads(DOCUMENT.read_text(encoding="utf-8"))["paths"].values()
    ids = sorted(one["operationId"] for methods in paths for one in methods.values())
    asked = [word for id in sample(ids) for word in ("--include-operation-id", id)]
    at_limits = cases(service, tmp_path, "--phases", "coverage", *asked)
    random = ("--phases", "fuzzing,stateful", "-n", str(examples(100)))
    assert at_limits + cases(service, tmp_path, *random) >= examples(10_000)
