import unicodedata

from hypothesis import given, settings
from hypothesis import strategies as st

from argo_compiler.diagnostics import (
    Diagnostic,
    DiagnosticError,
    Severity,
    Span,
    by_position,
    severity_counts_text,
    to_text,
)


def finding(severity=Severity.ERROR, code="il.x", **fields):
    return Diagnostic(code=code, severity=severity, message=fields.pop("message", "m"), **fields)


def columns(text: str) -> int:
    """Return the terminal columns by Unicode's annex 11 and its combining classes."""
    return sum(
        (1 + (unicodedata.east_asian_width(c) in "WF")) * (not unicodedata.combining(c))
        for c in text
    )


def test_text_has_position_message_line_mark_and_hint():
    text = to_text(
        [finding(span=Span(line=3, column=5, length=2), excerpt="abc def", hint="h")], "f"
    )
    assert text.splitlines() == [
        "f:3:5: error: m [il.x]",
        "    abc def",
        "        ^^",
        "    hint: h",
    ]


@settings(max_examples=200)
@given(st.text("ab \t測é\u0301ﾊ🛢", min_size=1, max_size=12), st.data())
def test_the_mark_is_below_the_span(line, data):
    start = data.draw(st.integers(0, len(line) - 1))
    length = data.draw(st.integers(1, len(line) - start))
    span = Span(line=1, column=start + 1, length=length)
    _, shown, mark, *_ = to_text([finding(span=span, excerpt=line)], "f").split("\n")
    assert len(mark) - len(mark.lstrip()) == 4 + columns(line[:start])
    assert mark.count("^") == max(1, columns(line[start : start + length]))
    assert shown == "    " + line.replace("\t", " ")


def test_a_mark_beyond_a_shortened_line_is_left_out():
    span = Span(line=1, column=50)
    assert "^" not in to_text([finding(span=span, excerpt="short")], "f")


def test_no_character_controls_the_terminal():
    bad = finding(message="\x1b[2J\rm", hint="\x07", span=Span(line=1, column=1), excerpt="\x1b[0m")
    text = to_text([bad], "a\x1bb")
    assert all(c.isprintable() or c == "\n" for c in text)


def test_diagnostics_are_sorted_by_position_and_counted():
    def at(line, column, severity, code):
        return finding(severity, code, span=Span(line=line, column=column))

    error, warning = Severity.ERROR, Severity.WARNING
    found = [
        finding(code="il.last"),
        at(2, 1, error, "il.c"),
        at(1, 9, error, "il.b"),
        at(1, 9, warning, "il.a"),
        at(1, 2, warning, "il.z"),
        finding(code="il.first"),
    ]
    ordered = ["il.z", "il.b", "il.a", "il.c", "il.last", "il.first"]
    assert [f.code for f in by_position(found)] == ordered
    caught = DiagnosticError("f", found)
    assert [f.code for f in caught.diagnostics] == ordered
    assert str(caught).endswith("\nf: 4 errors, 2 warnings")


def test_severities_are_counted_in_words():
    assert severity_counts_text([]) == "no findings"
    assert severity_counts_text([finding()]) == "1 error"
    assert severity_counts_text([finding(Severity.WARNING)] * 3) == "3 warnings"


def test_warnings_are_brief_beside_errors_only():
    span = Span(line=1, column=1)
    warning = finding(Severity.WARNING, span=span, excerpt="line", hint="way out")
    assert "way out" in to_text([warning, warning], "f")
    assert "way out" not in to_text([warning, finding(span=span)], "f")


def test_without_a_span_the_subject_is_shown():
    assert "tasks[3]: m" in to_text([finding(subject="tasks[3]")], "f")
