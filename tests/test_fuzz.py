"""A short run of the fuzzer; CONTRIBUTING has the long one."""

from tests.fuzz import fuzz


def test_mutated_scripts_and_files_end_in_missions_or_diagnostics() -> None:
    outcomes, failures = fuzz(range(2000), seed=0)
    assert not failures, failures[0].traceback
    assert all(outcomes[f"{kind}: mission"] > 20 for kind in ("script", "file"))
    assert all(outcomes[f"{kind}: refused"] > 20 for kind in ("script", "file"))
