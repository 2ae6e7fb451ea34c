"""Command that checks a commit message: `python .ci/check_commit_message.py FILE`.

Git calls it as a `commit-msg` hook with the file that holds the message. It prints what to change
and exits with status 1 if the message breaks a rule of CONTRIBUTING.
"""

import re
import sys
from pathlib import Path

MAX_SUBJECT = 72
"""characters of the first line"""
MADE_BY_GIT = ("Merge ", "Revert ", "fixup! ", "squash! ", "amend! ")
"""beginnings of subjects that Git writes itself"""
IMPERATIVES = {
    "bring",
    "embed",
    "feed",
    "need",
    "proceed",
    "seed",
    "shed",
    "speed",
    "spring",
    "swing",
}
"""verbs in the imperative that end as other forms of a verb do"""


def problems_of(message: str) -> list[str]:
    """Return what a commit message breaks of the rules, one sentence each."""
    lines = [line.rstrip() for line in message.splitlines() if not line.startswith("#")]
    while lines and not lines[0]:
        del lines[0]
    if not lines:
        return ["The message is empty."]
    subject, *rest = lines
    if subject.startswith(MADE_BY_GIT):
        return []
    problems = []
    if len(subject) > MAX_SUBJECT:
        problems.append(f"The subject has {len(subject)} characters; at most {MAX_SUBJECT} fit.")
    first = subject.split()[0]
    if not first[0].isupper():
        problems.append(
            f"The subject begins with a capital: '{first.capitalize()}', not '{first}'."
        )
    if re.search(r"(?:[^s]s|ed|ing)$", first.lower()) and first.lower() not in IMPERATIVES:
        problems.append(f"The subject begins with a verb in the imperative ('Add'), not '{first}'.")
    if subject.endswith("."):
        problems.append("The subject ends without a full stop.")
    if rest and rest[0]:
        problems.append("An empty line separates the subject from the body.")
    if not any(rest):
        problems.append("A body, after an empty line, says why the change is made.")
    return problems


def main() -> int:
    """Check the message in the file that is named on the command line, and return the status."""
    problems = problems_of(Path(sys.argv[1]).read_text(encoding="utf-8"))
    for problem in problems:
        print(f"commit message: {problem}", file=sys.stderr)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
