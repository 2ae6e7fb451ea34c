"""Tests of the comparison with stored results: each result that differs is named."""

import pytest

from benchmarks.same_results import main


@pytest.mark.long
def test_a_result_that_differs_is_named(tmp_path, capfd):
    stored = tmp_path / "digests.txt"
    only = ["plans", "--only", "rounds_and_windows"]
    main([str(stored), *only, "--write"])
    with pytest.raises(SystemExit, match="False"):
        main([str(stored), *only])
    assert capfd.readouterr().out.endswith("\nall results are the same\n")
    digest = stored.read_text()[:16]
    stored.write_text(stored.read_text().replace(digest, "0" * 16))
    with pytest.raises(SystemExit, match="True"):
        main([str(stored), *only])
    name = "plans: rounds_and_windows, exit statuses [0]"
    assert capfd.readouterr().out.endswith(f"\nbefore {'0' * 16} {name}\n today {digest} {name}\n")
