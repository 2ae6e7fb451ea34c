"""What is said about a sentence that makes no sense: at which words, and what may stand there."""

from argo_compiler.base.listing import listed
from argo_compiler.script.syntax.grammar.parser import StumbleError
from argo_compiler.script.syntax.text.source import Diagnostics, ScriptText
from argo_compiler.script.syntax.text.spelling import candidates
from argo_compiler.script.syntax.understanding import Understanding
from argo_compiler.script.syntax.words.joints import VERBS
from argo_compiler.script.syntax.words.word import Word

_MOST = 8
_UNTOLD = frozenset(
    [
        *("STRING", "LPAR_CALLED", "LPAR_BOUND", "SECOND_BOUND", "JOINTS", "STANDING", "SHOWN_IN"),
        *("ABOUT", "LEAVING", "JOINT", "X", "Y", "Z", "RAD", "MODE", "VALUE", "FINISHING"),
        *("STOPPING", "INCLUDED", "EXCLUDED", "ENDLESS", "IN_CIRCLES"),
    ]
)
"""terminals that need not be named, as they are rare"""


def not_understood(
    text: ScriptText, stumble: StumbleError, understanding: Understanding, diagnostics: Diagnostics
) -> None:
    """The error of a sentence that makes no sense, at the words that make none."""
    found = understanding.words(text)
    at = next((w for w in found if w.type in ("WORD", "CANNOT")), None)
    if at is None and stumble.at < len(found):
        at = found[stumble.at]
    hint = _hint(text, at, found, stumble, understanding)
    if at is None:
        message = "the sentence ends where more is expected"
        diagnostics.error("unfinished", message, text.span(len(text.content)), hint)
        return
    said = text.content[at.start : at.end]
    message = f"can't understand `{said}` here"
    if at.type == "CANNOT":
        message = f"`{said}` is nothing that the robot can do"
    diagnostics.error("not-understood", message, text.span(at.start, at.end), hint)


def _hint(
    text: ScriptText,
    at: Word | None,
    found: list[Word],
    stumble: StumbleError,
    understanding: Understanding,
) -> str:
    parts = []
    if at is not None and at.type == "WORD":
        meant = candidates(text.content[at.start : at.end], understanding.known)
        if meant and text.content[at.start : at.end].lower() not in meant:
            parts.append(f"is {listed((f'`{word}`' for word in sorted(meant)[:3]), 'or')} meant?")
    if at is None or (stumble.at < len(found) and found[stumble.at] is at):
        before = tuple(word.type for word in found[: stumble.at])
        follow = _may_follow(before, understanding)
        if follow:
            parts.append(f"here may stand {listed(follow, 'or')}")
    samples = understanding.language.prose.samples
    verb = next((w.type for w in found if w.type in samples), "MEASURE")
    parts.append(f"say, `{samples[verb]}`")
    return "; ".join(parts)


def _may_follow(before: tuple[str, ...], understanding: Understanding) -> list[str]:
    """What the grammar accepts behind these words, in words of the language. Where an order may
    begin there is too much to be told."""
    accepted = understanding.grammar.accepted(before)
    if accepted.issuperset(VERBS[:4]):
        return []
    prose, lexicon = understanding.language.prose, understanding.language.lexicon
    shown = {type_: said for type_, said in prose.kinds.items() if type_ in accepted}
    for (type_, _), phrases in lexicon.phrases.items():
        if type_ in accepted and type_ not in _UNTOLD:
            shown.setdefault(type_, f"`{phrases[0]}`")
    return list(dict.fromkeys(shown.values()))[:_MOST]
