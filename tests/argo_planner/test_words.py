"""Error messages with the options and commands that help."""

import pytest

from argo_compiler.base.errors import Conflict, Invalid, Remedy, RemedyChoice
from argo_compiler.diagnostics import Diagnostic, Severity
from argo_planner.terminal.words import add_options_to_hints, error_text, insert_keep_order_option


@pytest.mark.parametrize("remedy", Remedy)
def test_each_remedy_has_words(remedy):
    text = error_text(Invalid("no", remedies=(remedy,), about="a file"), "argo: ")
    assert text.startswith("argo: no (")
    assert "--" in text or "argo " in text


def test_a_command_names_the_file_so_that_it_can_be_pasted():
    error = Conflict("my run.journal: is there", remedies=(Remedy.RESUME,), about="my run.journal")
    assert error_text(error) == "my run.journal: is there (argo resume 'my run.journal')"


@pytest.mark.parametrize(
    ("hint", "remedy", "choice", "said"),
    [
        ("choose area 1 or 2", Remedy.CHOOSE_START, ("area", ("1", "2")),
         "choose with --start-area 1 or --start-area 2"),
        ("name one, or choose area 1, 2 or 13", Remedy.CHOOSE_END, ("area", ("1", "2", "13")),
         "name one, or choose with --end-area 1, --end-area 2 or --end-area 13"),
        ("choose none, or begin elsewhere", Remedy.CHOOSE_START, None,
         "choose none, or begin elsewhere (--start-area)"),
        ("choose the site umad", Remedy.CHOOSE_SITE, ("the site", ("umad",)),
         "choose it with --site umad"),
    ],
)  # fmt: skip
def test_hints_name_the_options(hint, remedy, choice, said):
    found = Diagnostic(
        code="c",
        severity=Severity.ERROR,
        message="m",
        hint=hint,
        remedies=(remedy,),
        choice=choice and RemedyChoice(remedy, *choice),
    )
    (shown,) = add_options_to_hints([found], "m.txt")
    assert shown.hint == said


def test_an_order_that_is_kept_names_the_option():
    assert (
        insert_keep_order_option("kept: the order as written")
        == "kept: the order as written (--keep-order)"
    )
