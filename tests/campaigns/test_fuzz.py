"""Short runs of the fuzzer; CONTRIBUTING has the long ones."""

from tests.campaigns.fuzz import fuzz, fuzz_sentences
from tests.conftest import examples


def test_mutated_scripts_and_files_end_in_missions_or_diagnostics() -> None:
    outcomes, failures = fuzz(range(examples(2000)), seed=0)
    assert not failures, failures[0].traceback
    assert all(outcomes[f"{kind}: mission"] > examples(20) for kind in ("script", "file"))
    assert all(outcomes[f"{kind}: refused"] > examples(20) for kind in ("script", "file"))


def test_sentences_made_from_the_grammar_keep_the_laws() -> None:
    outcomes, failures = fuzz_sentences(range(examples(200)), seed=0)
    assert not failures, failures[0].traceback
    assert outcomes["sentence: mission"] > examples(30)
    assert outcomes["sentence: refused"] > examples(30)
