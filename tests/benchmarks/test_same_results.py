"""Results are compared with kept ones, and each that differs is named."""

import pytest

from benchmarks.same_results import main


@pytest.mark.long
def test_a_result_that_differs_is_named(tmp_path, capfd):
    kept = tmp_path / "digests.txt"
    only = ["plans", "--only", "rounds_and_windows"]
    main([str(kept), *only, "--write"])
    with pytest.raises(SystemExit, match="False"):
        main([str(kept), *only])
    assert capfd.readouterr().out.endswith("\nall are the same\n")
    digest = kept.read_text()[:16]
    kept.write_text(kept.read_text().replace(digest, "0" * 16))
    with pytest.raises(SystemExit, match="True"):
        main([str(kept), *only])
    name = "plans: rounds_and_windows, exit statuses [0]"
    assert capfd.readouterr().out.endswith(f"\nbefore {'0' * 16} {name}\n today {digest} {name}\n")
