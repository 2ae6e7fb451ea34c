"""The service does what its OpenAPI document says, whatever it is asked."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from argo_planner.service.web.app import document
from tests.argo_planner.service.served import ALL, Served
from tests.conftest import examples

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


def asked(service: Served, count: int, phases: str, folder: Path) -> int:
    """Lets schemathesis ask the service; how many cases it has made."""
    answer = subprocess.run(
        [
            Path(sys.executable).with_name("schemathesis"),
            "run",
            f"http://{service.address}/api/openapi.json",
            *("-H", f"Authorization: Bearer {ALL}"),
            *("--phases", phases, "-n", str(count), "--seed", "1", "--no-color"),
            *("--exclude-checks", LEFT_OUT, "--generation-database", "none"),
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
def test_no_answer_is_against_the_document(service: Served, tmp_path: Path) -> None:
    assert asked(service, 3, "fuzzing", tmp_path) > 100


@pytest.mark.long
def test_cases_with_links_are_answered_as_documented(service: Served, tmp_path: Path) -> None:
    count = asked(service, examples(60), "coverage,fuzzing,stateful", tmp_path)
    assert count >= examples(10_000)
