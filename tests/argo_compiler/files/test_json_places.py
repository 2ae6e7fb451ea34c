"""Tests that the place of a path in a JSON text is the place of the path's value."""

import json

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_compiler.diagnostics.subject import split_subject
from argo_compiler.files.json_places import (
    JsonText,
    find_duplicate_keys,
    find_places_or_parents,
    format_path,
)

KEYS = st.text('ab"\\ü\n{[:,', max_size=4)
DATA = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | KEYS,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(KEYS, inner, max_size=4),
    max_leaves=20,
)
LAYOUTS = st.sampled_from([{}, {"indent": 2}, {"indent": "\t"}, {"separators": (",", ":")}])


def paths(data, at=()):
    yield at, data
    if isinstance(data, dict | list):
        for step, inner in data.items() if isinstance(data, dict) else enumerate(data):
            yield from paths(inner, (*at, step))


@settings(max_examples=200)
@given(DATA, LAYOUTS, st.booleans())
def test_the_text_at_a_place_is_the_value_of_its_path(data, layout, ascii):
    text = json.dumps(data, ensure_ascii=ascii, **layout)
    everything = dict(paths(data))
    places = find_places_or_parents(JsonText(text), everything)
    lines = text.split("\n")
    for path, value in everything.items():
        span = places[path]
        shown = lines[span.line - 1][span.column - 1 :][: span.length]
        container = isinstance(value, dict | list)
        if isinstance(value, dict) and value and not (path and isinstance(path[-1], str)):
            # An object in a list is shown by its first member.
            key, value = next(iter(value.items()))
            shown_key, shown = split_key(shown)
            assert shown_key == key
            container = isinstance(value, dict | list)
        elif path and isinstance(path[-1], str):
            shown_key, shown = split_key(shown)
            assert shown_key == path[-1]
        assert shown == "[{"[isinstance(value, dict)] if container else json.loads(shown) == value


def split_key(shown):
    key, end = json.JSONDecoder().raw_decode(shown)
    return key, shown[end:].lstrip(": ")


@settings(max_examples=100)
@given(DATA, LAYOUTS)
def test_written_data_have_no_duplicate_keys(data, layout):
    assert find_duplicate_keys(JsonText(json.dumps(data, **layout)), 9) == {}


def test_the_place_of_a_missing_path_is_its_longest_existing_part():
    text = JsonText('{"tasks": [\n  {"name": "A"}\n]}')
    places = find_places_or_parents(text, [("tasks", 0, "pose", "x"), ("tasks", 7), ("dock",)])
    assert (places["tasks", 0, "pose", "x"].line, places["tasks", 0, "pose", "x"].column) == (2, 4)
    assert places["tasks", 7].line == 1
    assert places[("dock",)].line == 1


def test_duplicate_keys_are_found_at_any_depth_and_in_any_spelling():
    text = JsonText('{"a": 1, "b": [{"c": 1,\n "\\u0063": 2, "d": {"c": 3}}],\n"a": {"a": 0}}')
    duplicates = find_duplicate_keys(text, 9)
    assert {path: (s.line, s.column) for path, s in duplicates.items()} == {
        ("b", 0, "c"): (1, 17),
        ("a",): (1, 2),
    }
    last = find_places_or_parents(text, duplicates)
    assert (last["b", 0, "c"].line, last["b", 0, "c"].column) == (2, 2)
    assert last[("a",)].line == 3
    assert len(find_duplicate_keys(text, 1)) == 1


@pytest.mark.parametrize("path", ["tasks[3].transitions[0].target", "tasks", "groups[10].name"])
def test_a_parsed_path_is_formatted_as_before(path):
    assert format_path(split_subject(path)) == path


def test_deep_nesting_is_no_problem():
    text = JsonText('{"a": ' + "[" * 100_000 + "]" * 100_000 + "}")
    assert find_places_or_parents(text, [("a", 0, 0)])["a", 0, 0].column == 9
