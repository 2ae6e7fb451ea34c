"""The hook that checks commit messages accepts what CONTRIBUTING asks for, and nothing else."""

import runpy

import pytest

from tests.processes import ROOT, run_python

HOOK = ROOT / ".ci" / "check_commit_message.py"
BODY = "\n\nOtherwise two readers of durations would differ.\n"
problems_of = runpy.run_path(str(HOOK))["problems_of"]


@pytest.mark.parametrize(
    "message",
    [
        "Read durations with the compiler's reader" + BODY,
        "Pass the clock to the executor" + BODY,
        "Speed up the import of scripts" + BODY,
        "X" * 72 + BODY,
        "Add a glossary" + BODY + "# Please enter the commit message for your changes.\n",
        "Merge branch 'main' into words\n",
        'Revert "Add a glossary"\n\nThis reverts commit 1234.\n',
    ],
)
def test_it_accepts(message):
    assert problems_of(message) == []


@pytest.mark.parametrize(
    ("message", "problem"),
    [
        ("", "The message is empty."),
        ("# only a comment\n", "The message is empty."),
        ("X" * 73 + BODY, "The subject has 73 characters; at most 72 fit."),
        ("add a glossary" + BODY, "begins with a capital: 'Add', not 'add'."),
        ("Adds a glossary" + BODY, "a verb in the imperative ('Add'), not 'Adds'."),
        ("Added a glossary" + BODY, "a verb in the imperative ('Add'), not 'Added'."),
        ("Adding a glossary" + BODY, "a verb in the imperative ('Add'), not 'Adding'."),
        ("Add a glossary." + BODY, "ends without a full stop."),
        ("Add a glossary\nOtherwise …\n", "An empty line separates the subject from the body."),
        ("Add a glossary\n", "A body, after an empty line, says why the change is made."),
    ],
)
def test_it_refuses(message, problem):
    assert any(problem in each for each in problems_of(message))


@pytest.mark.parametrize(("subject", "status"), [("Add a glossary", 0), ("Adds a glossary", 1)])
def test_git_learns_it_by_the_exit_status(tmp_path, subject, status):
    file = tmp_path / "COMMIT_EDITMSG"
    file.write_text(subject + BODY, encoding="utf-8")
    hook = run_python(HOOK, file, check=False)
    assert hook.returncode == status
    assert ("'Adds'" in hook.stderr) is bool(status)
