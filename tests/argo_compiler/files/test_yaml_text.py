"""YAML follows the core schema of YAML 1.2, and what Argo writes is read back by any reader."""

import math

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from argo_compiler.base.errors import Invalid
from argo_compiler.files.yaml_text import dump_yaml, load_yaml


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("010", 10), ("-010", -10), ("+8", 8), ("0o10", 8), ("0x1F", 31), ("0", 0),
        ("1:30", "1:30"), ("12:30", "12:30"), ("1:30.5", "1:30.5"), ("1_000", "1_000"),
        ("0b11", "0b11"), ("yes", "yes"), ("No", "No"), ("on", "on"), ("OFF", "OFF"), ("y", "y"),
        ("true", True), ("False", False), ("tRUE", "tRUE"), ("~", None), ("null", None), ("", None),
        ("nUll", "nUll"), ("2026-11-27", "2026-11-27"), ("1e3", 1000.0), ("1.", 1.0), (".5", 0.5),
        ("08.50", 8.5), (".inf", math.inf), ("-.INF", -math.inf), ("+.Inf", math.inf),
        (".e1", ".e1"), ("0o8", "0o8"), ("=", "="), ('"010"', "010"),
    ],
)  # fmt: skip
def test_plain_scalars_follow_the_core_schema(text, value):
    found = load_yaml(f"key: {text}", "file.yaml")["key"]
    assert (found, type(found)) == (value, type(value))


def test_not_a_number_is_read():
    assert math.isnan(load_yaml(".nan", "file.yaml"))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a: 1\nb: [1", r"^file\.yaml:2:\d+: the file is not YAML: "),
        ("a: 1\n\tb: 2", r"^file\.yaml:2:1: the file is not YAML: "),
        ("a: 1\nb: 2\na: 3", r"^file\.yaml:3:1: `a` is given twice; it was first given at line 1$"),
        ("10: 1\n010: 2", r"^file\.yaml:2:1: `010` is given twice"),
        ("a: !!int 1:30", "^file.yaml: the file is not YAML: it has a value that can.t be read"),
        ("a: !!python/name:os.system x", r"^file\.yaml:1:4: the file is not YAML: could not det"),
        ("[" * 5000, "^file.yaml: the file is not YAML: it is nested too deeply"),
        ("a: " + "9" * 5000, "^file.yaml: the file is not YAML: it has a value that can.t be read"),
    ],
)
def test_errors_have_file_and_line(text, message):
    with pytest.raises(Invalid, match=message):
        load_yaml(text, "file.yaml")


def test_mappings_are_merged():
    found = load_yaml("a: &a {x: 1, y: 2}\nb: {<<: *a, x: 3}", "file.yaml")
    assert found["b"] == {"x": 3, "y": 2}


_CONFUSING = ["010", "1:30", "yes", "1e3", "0o7", "~", "", "2026-11-27", "<<", "=", "null", ".inf"]
_TEXTS = st.sampled_from(_CONFUSING) | st.text(st.characters(codec="utf-8"), max_size=8)
_DATA = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | _TEXTS,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(_TEXTS, inner, max_size=4),
    max_leaves=8,
)


@given(_DATA, st.sampled_from([None, True, False]))
def test_what_is_written_is_read_back_by_yaml_1_2_and_by_yaml_1_1(data, flow):
    text = dump_yaml({"data": data}, flow=flow)
    assert load_yaml(text, "file.yaml") == {"data": data}
    assert yaml.safe_load(text) == {"data": data}


def test_merges_that_repeat_without_limit_are_refused() -> None:
    lines = ["a0: &a0 {x: 1}"]
    lines += [f"a{k}: &a{k}\n  <<: [*a{k - 1}, *a{k - 1}]" for k in range(1, 60)]
    with pytest.raises(Invalid, match=r"x:\d+:3: .*repeat more than 100000 fields"):
        load_yaml("\n".join(lines), "x")


def test_merged_fields_are_those_of_the_mappings_that_they_name() -> None:
    text = "a: &a {x: 1, y: 1}\nb: &b\n  <<: *a\n  x: 2\nc: {<<: [*b, {y: 3, z: 3}]}\n"
    assert load_yaml(text, "x")["c"] == {"x": 2, "y": 1, "z": 3}
