"""The draft of a script as a file that a person can read and edit.

For each line of the script there is a block: its number and text, and below that what it becomes.

    6 | I need pressure gauge 1 and then valve R25.
    proposed: Check checkpoint 1.
    proposed: Check checkpoint 4.
    not used: I need

A person decides by changing the words before the colon: `confirmed` accepts what is proposed,
`said` stands before other sentences, and `set aside by hand` before nothing. Reading takes only
these.
"""

import re
from collections.abc import Iterator

from argo_compiler.base.errors import Invalid
from argo_compiler.script.drafts.draft import Act, Draft, DraftLine, LineDecision, decisions_of

VERSION = 1
"""version of this format"""
_FIRST = f"# draft, version {VERSION}"
_HEAD = re.compile(rf"{_FIRST}(?:: .*)?")
_LINE = re.compile(r"\s*[0-9]+(?:\.[0-9]+)? \| (.*)")
_KEYS = {Act.CONFIRMED: "confirmed", Act.SAID: "said", Act.SET_ASIDE: "set aside by hand"}
_ACTS = {key: act for act, key in _KEYS.items()}
_LONGEST = 500
"""characters of a line that are shown"""


def draft_text(draft: Draft) -> str:
    """Return the draft as text."""
    width = max((len(line.label) for line in draft.lines), default=1)
    blocks = ["\n".join(_block(line, width)) for line in draft.lines]
    return "\n\n".join([f"{_FIRST}: {draft.source_name}", *blocks]) + "\n"


def _block(line: DraftLine, width: int) -> Iterator[str]:
    yield f"{line.label:>{width}} | {line.text}"
    if line.place:
        yield f"place: {line.place}"
    if line.act is not None:
        key = _KEYS[line.act]
        yield from (f"{key}: {sentence}" for sentence in line.sentences or ("",))
        if not line.is_left:
            return
    key = str(line.state)
    if line.sentences and line.act is None:
        yield from (f"{key}: {sentence}" for sentence in line.sentences)
    else:
        yield f"{key}: {line.reason}" if line.reason else key
    if line.unused:
        yield f"not used: {', '.join(line.unused)}"
    if line.hint:
        yield f"hint: {line.hint}"
    for number, sentences in enumerate(line.choices, start=1):
        yield f"choice {number}: {' '.join(sentences) or '(set it aside)'}"


def read_decisions(text: str, source_name: str) -> tuple[LineDecision, ...]:
    """Return what a person has decided on in the text of a draft.

    Raises:
        Invalid: It is no draft, or one of another version.
    """
    first, *rest = text.split("\n")
    head = _HEAD.fullmatch(first.strip("\ufeff \t\r"))
    if head is None:
        raise Invalid(
            f"{source_name} is no draft of this version of Argo, as its first line is not "
            f"`{_FIRST}`; remove the file to decide anew"
        )
    found: list[tuple[str, Act | None, tuple[str, ...]]] = []
    for line in rest:
        if (begun := _LINE.fullmatch(line.rstrip())) is not None:
            found.append((" ".join(begun[1].split()), None, ()))
            continue
        key, colon, said = line.partition(":")
        act = _ACTS.get(" ".join(key.split()))
        if act is None or not found:
            continue
        text_, _, sentences = found[-1]
        added = (said.strip(),) if colon and said.strip() and act is not Act.SET_ASIDE else ()
        found[-1] = (text_, act, (*sentences, *added))
    return decisions_of(found)
