"""Dataclasses that are made faster than Python's own."""

import pickle
from dataclasses import dataclass as plain_dataclass
from dataclasses import field, fields, replace

import pytest

from argo_compiler.base.records import dataclass


@dataclass(frozen=True)
class Place:
    """A record with a field that is not compared, and one that is not shown."""

    name: str
    floors: tuple[int, ...] = ()
    note: str = field(default="", compare=False)
    secret: str = field(default="", repr=False)


@plain_dataclass(frozen=True)
class PlainPlace:
    """The same as a dataclass of Python."""

    name: str
    floors: tuple[int, ...] = ()
    note: str = field(default="", compare=False)
    secret: str = field(default="", repr=False)


@dataclass(frozen=True, slots=True)
class Number:
    """A record with one field."""

    value: float


@dataclass
class Mutable:
    """A record that is not frozen."""

    items: list[int] = field(default_factory=list)


VALUES = [("a",), ("a", (1, 2)), ("b", (1, 2), "note"), ("a", (), "other"), ("a", (), "", "x")]


@pytest.mark.parametrize("one", VALUES)
@pytest.mark.parametrize("other", VALUES)
def test_records_compare_and_hash_as_dataclasses_do(one, other):
    same = PlainPlace(*one) == PlainPlace(*other)
    assert (Place(*one) == Place(*other)) is same
    assert (hash(Place(*one)) == hash(Place(*other))) is same


@pytest.mark.parametrize("values", VALUES)
def test_records_are_printed_as_dataclasses_are(values):
    assert repr(Place(*values)) == repr(PlainPlace(*values)).replace("PlainPlace", "Place")


def test_records_of_other_classes_differ():
    assert Place("a") != PlainPlace("a")
    assert Place("a") != "a"


def test_a_record_with_one_value_that_is_not_a_number_equals_itself_only():
    nan = Number(float("nan"))
    assert nan == nan
    assert nan != Number(float("nan"))
    assert nan != Number(1.0)


def test_a_record_that_is_not_frozen_has_no_hash():
    assert Mutable([1]) == Mutable([1])
    with pytest.raises(TypeError, match="unhashable"):
        hash(Mutable())


def test_records_have_fields_can_be_replaced_and_pickled():
    place = Place("a", (1,))
    assert [one.name for one in fields(place)] == ["name", "floors", "note", "secret"]
    assert replace(place, name="b") == Place("b", (1,))
    assert pickle.loads(pickle.dumps((place, Number(1.0)))) == (place, Number(1.0))
