"""Documents as people send them: each becomes what a careful reader takes it for, once all that is
proposed is confirmed and all questions are answered; nothing is asked about too little."""

import os
from pathlib import Path

import pytest

from argo_env.planning.opening import open_site
from tests.argo_compiler.script.judging.documents import judge_document, load_documents


def test_given_documents_become_their_missions() -> None:
    folder = os.environ.get("ARGO_DOCUMENTS")
    if not folder:
        pytest.skip("ARGO_DOCUMENTS names no folder: no other people's documents are tried")
    catalog = open_site("umad").catalog
    documents = load_documents(Path(folder))
    assert documents, f"{folder} has no documents"
    found = {d.path.name: judge_document(d, catalog) for d in documents}
    wrong = {name: problems for name, problems in found.items() if problems}
    assert not wrong, "\n".join(f"{name}: {problems}" for name, problems in wrong.items())
