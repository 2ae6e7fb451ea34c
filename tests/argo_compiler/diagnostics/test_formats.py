"""Diagnostics for other programs: JSON, and SARIF as the standard and code hosts require it."""

import json

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from jsonschema import Draft202012Validator

from argo_compiler.diagnostics import CODES, Diagnostic, Severity, Span, to_json, to_sarif

FINDINGS = st.lists(
    st.builds(
        Diagnostic,
        code=st.sampled_from(sorted(CODES)),
        severity=st.sampled_from(Severity),
        message=st.text(max_size=9),
        span=st.none()
        | st.builds(
            Span, line=st.integers(1, 99), column=st.integers(1, 99), length=st.integers(0, 9)
        ),
        excerpt=st.none() | st.text(max_size=9),
        hint=st.none() | st.text(max_size=9),
        subject=st.none() | st.sampled_from(["tasks[0]", "tasks[1].transitions[0]"]),
    ),
    max_size=5,
)


def record(required="", **properties):
    """Return the schema of an object with these properties and no others."""
    return {
        "type": "object",
        "required": required.split(),
        "properties": properties,
        "additionalProperties": False,
    }


def listed(items, **more):
    return {"type": "array", "items": items, **more}


STRING, COUNT = {"type": "string"}, {"type": "integer", "minimum": 1}
TEXT = record("text", text=STRING, markdown=STRING)
LEVEL = {"enum": ["none", "note", "warning", "error"]}
RULE = record(
    "id shortDescription fullDescription help defaultConfiguration",
    id=STRING,
    name={**STRING, "maxLength": 255},
    shortDescription=TEXT,
    fullDescription=TEXT,
    help={**TEXT, "required": ["text", "markdown"]},
    defaultConfiguration=record(level=LEVEL),
)
PHYSICAL = record(
    "artifactLocation region",
    artifactLocation=record("uri", uri={**STRING, "minLength": 1}),
    region=record(
        "startLine",
        startLine=COUNT,
        startColumn=COUNT,
        endLine=COUNT,
        endColumn=COUNT,
        snippet=TEXT,
    ),
)
LOCATION = record(
    "physicalLocation",
    physicalLocation=PHYSICAL,
    logicalLocations=listed(record(fullyQualifiedName=STRING)),
)
RESULT = record(
    "ruleId level message locations partialFingerprints",
    ruleId=STRING,
    ruleIndex={"type": "integer", "minimum": 0},
    level=LEVEL,
    message=TEXT,
    locations=listed(LOCATION, minItems=1),
    partialFingerprints={
        "type": "object",
        "required": ["primaryLocationLineHash"],
        "additionalProperties": STRING,
    },
)
DRIVER = record(
    "name semanticVersion rules",
    name=STRING,
    version=STRING,
    semanticVersion={"pattern": r"^\d+\.\d+\.\d+"},
    rules=listed(RULE, uniqueItems=True),
)
RUN = record(
    "tool results",
    tool=record("driver", driver=DRIVER),
    columnKind={"enum": ["utf16CodeUnits", "unicodeCodePoints"]},
    results=listed(RESULT),
)
SARIF = record(
    "$schema version runs",
    **{"$schema": {**STRING, "pattern": "sarif-2.1.0"}},
    version={"const": "2.1.0"},
    runs=listed(RUN, minItems=1),
)
"""the parts of SARIF 2.1.0 that Argo writes, as GitHub's code scanning requires them"""


@settings(max_examples=60)
@given(FINDINGS)
def test_sarif_has_the_form_that_code_hosts_require(findings):
    log = json.loads(to_sarif(findings, "missions/plan.json"))
    Draft202012Validator(SARIF).validate(log)
    (run,) = log["runs"]
    rules = run["tool"]["driver"]["rules"]
    assert len(run["results"]) == len(findings)
    for result, finding in zip(run["results"], findings, strict=True):
        assert rules[result["ruleIndex"]]["id"] == result["ruleId"] == finding.code
        assert result["level"] == finding.severity
        assert finding.message in result["message"]["text"]
        region = result["locations"][0]["physicalLocation"]["region"]
        if finding.span:
            assert region["startLine"] == region["endLine"] == finding.span.line
            assert region["startColumn"] == finding.span.column
            assert region["endColumn"] > region["startColumn"]
    prints = [r["partialFingerprints"]["primaryLocationLineHash"] for r in run["results"]]
    assert len(set(prints)) == len(prints)


@pytest.mark.parametrize(
    ("name", "uri"),
    [
        ("missions/plan #1.json", "missions/plan%20%231.json"),
        ("Öl.json", "%C3%96l.json"),
        ("/m/a b.json", "file:///m/a%20b.json"),
    ],
)
def test_sarif_names_the_file_by_a_uri(name, uri):
    finding = Diagnostic(code="file.missing", severity=Severity.ERROR, message="m")
    (result,) = json.loads(to_sarif([finding], name))["runs"][0]["results"]
    assert result["locations"][0]["physicalLocation"]["artifactLocation"] == {"uri": uri}


def test_a_fingerprint_outlives_lines_before_it():
    def fingerprint(line):
        finding = Diagnostic(
            code="il.unknown-target",
            severity=Severity.ERROR,
            message=f"at {line}",
            span=Span(line=line, column=1),
            excerpt="  target",
        )
        (result,) = json.loads(to_sarif([finding], "f"))["runs"][0]["results"]
        return result["partialFingerprints"]

    assert fingerprint(3) == fingerprint(30)


@settings(max_examples=60)
@given(FINDINGS)
def test_json_holds_all_of_every_finding(findings):
    data = json.loads(to_json(findings, "plan.json"))
    assert list(data) == ["version", "source", "errors", "warnings", "notes", "diagnostics"]
    assert (data["version"], data["source"]) == (1, "plan.json")
    assert data["errors"] + data["warnings"] + data["notes"] == len(findings)
    assert data["errors"] == sum(f.severity is Severity.ERROR for f in findings)
    fields = {"code", "severity", "message", "span", "excerpt", "hint", "subject"}
    assert all(set(entry) == fields for entry in data["diagnostics"])
    assert [Diagnostic.model_validate(entry) for entry in data["diagnostics"]] == findings
