"""Tests of the comparison with stored results: each result that differs is named."""

import json

import pytest

from benchmarks.same_results import main, without_prose


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


@pytest.mark.parametrize("separators", [(",", ":"), (", ", ": ")])
def test_only_texts_of_several_words_are_prose(separators):
    data = {"a key": "one", "b": 'two "words"', "c": ["x", "y z", ": ", 1.5]}
    expected = {"a key": "one", "b": "PROSE", "c": ["x", "PROSE", "PROSE", 1.5]}
    content = json.dumps(data, separators=separators).encode()
    assert json.loads(without_prose(".json", content)) == expected
