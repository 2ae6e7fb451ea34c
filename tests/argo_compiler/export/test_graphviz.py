import pytest
from hypothesis import given
from hypothesis import strategies as st
from lark import Lark, Transformer

from argo_compiler.export import to_dot
from argo_compiler.hfsm import lower
from argo_compiler.il import (
    Condition,
    ConditionType,
    EventKind,
    Group,
    Mission,
    OnFailure,
    Reaction,
    Response,
)
from tests.argo_compiler.export import missions as m
from tests.mission_parts import HERE
from tests.mission_writing import drive, measure, way

# Part of the grammar in Graphviz' documentation that the exporter uses.
GRAMMAR = r"""
    start: "digraph" ID "{" statement* "}"
    statement: ID "=" value ";"                          -> setting
             | "subgraph" ID "{" statement* "}"          -> cluster
             | ID attributes? ";"                        -> node
             | ID "->" ID attributes? ";"                -> edge
    attributes: "[" ID "=" value ("," ID "=" value)* "]"
    value: ID | NUMBER | STRING
    ID: /[a-zA-Z_][a-zA-Z_0-9]*/
    NUMBER: /-?(\.[0-9]+|[0-9]+(\.[0-9]*)?)/
    STRING: /"(\\.|[^"\\])*"/s
    %ignore /\s+/
"""


class Reader(Transformer):
    """Reader of a graph into nested lists: settings, clusters, nodes and edges."""

    def value(self, parts):
        text = str(parts[0])
        return text[1:-1] if text.startswith('"') else text

    def attributes(self, parts):
        return {str(k): v for k, v in zip(parts[::2], parts[1::2], strict=True)}

    def setting(self, parts):
        return ("setting", str(parts[0]), parts[1])

    def cluster(self, parts):
        return ("cluster", str(parts[0]), parts[1:])

    def node(self, parts):
        return ("node", str(parts[0]), parts[1] if len(parts) > 1 else {})

    def edge(self, parts):
        return ("edge", str(parts[0]), str(parts[1]), parts[2] if len(parts) > 2 else {})

    def start(self, parts):
        return parts[1:]


PARSER = Lark(GRAMMAR, parser="lalr", transformer=Reader())


def displayed_label(label):
    """Return the text that Graphviz shows for a label with no escapes but those of `to_dot`."""
    out, escaped = "", False
    for c in label:
        if escaped:
            out += "\n" if c == "n" else c
        elif c != "\\":
            out += c
        escaped = c == "\\" and not escaped
    return out.replace("&amp;", "&")


LOW = Condition(type=ConditionType.LESS, object_id="1", param1=2)


@pytest.fixture
def mission():
    measured = measure("B", way("A", LOW), object_id="1", on_failure=OnFailure.RETURN)
    return Mission(
        tasks=(drive("A", "B"), measured),
        groups=(Group(name="G", start="A", end="B", max_repeat_duration=60),),
        reactions=(Reaction(event=EventKind.GAS_LEAK, response=Response.ABORT),),
        dock=HERE,
    )


def test_groups_and_all_reactions_together_are_clusters(mission):
    graph = PARSER.parse(to_dot(lower(mission)))
    clusters = {item[1]: item[2] for item in graph if item[0] == "cluster"}
    assert {item[1] for item in clusters["cluster_g1"] if item[0] == "node"} == {"t0", "t1"}
    assert clusters["cluster_reactions"][-1][2]["label"] == "gas leak: abort"


def test_edge_labels_give_the_reason(mission):
    graph = PARSER.parse(to_dot(lower(mission)))
    edges = [(a, b, attributes.get("label", "")) for kind, a, b, attributes in
             (item for item in graph if item[0] == "edge")]  # fmt: skip
    assert edges == [
        ("start", "t0", ""),
        ("t0", "t1", ""),
        ("t1", "t0", "#1 < 2"),
        ("t1", "r1", ""),
        ("t1", "t2", "failed"),
        ("t2", "done", ""),
        ("r1", "t0", "repeat, for 60 s"),
        ("r1", "done", ""),
        ("t0", "r1", "time out after 60 s"),
    ]


@given(st.text(min_size=1))
def test_any_name_is_a_label(name):
    graph = PARSER.parse(to_dot(lower(m.repeated(measure(name, object_id="1")))))
    cluster = next(item for item in graph if item[0] == "cluster")
    assert len([item for item in graph if item[0] in ("node", "cluster")]) == 6
    label = next(item[2]["label"] for item in cluster[2] if item[0] == "node")
    if name.isprintable():
        assert displayed_label(label) == name
