"""Positive evidence that a piece has no effect: what it is, and that it names nothing of a mission.

A piece that is only unknown is never set aside.
"""

import re
from collections.abc import Callable

from argo_compiler.script.documents.source import ScriptText
from argo_compiler.script.proposals.mentions import OF_FORMS, Mentions
from argo_compiler.script.sentences.tree.places import DockLocation
from argo_compiler.script.sentences.words.language import Language
from argo_compiler.script.sentences.words.prose import cue_pattern

STATEMENT = "a statement that names nothing of the mission"
_SEPARATOR = re.compile(r"\W*([-=_*~])\1{2,}.*?\1{3,}\W*")
_INITIALS = re.compile(r"(?:[A-ZÄÖÜ]\.?\s?){2,3}")
_NAME = re.compile(r"(?:[^\W\d_a-zäöü][\w'-]*\.?\s?){1,3}")
_LEAD_IN = re.compile(r"[^,]{3,60},\s+")
_MOST_WORDS = 6
"""of a heading in capitals"""
_BLANK_LABELS = re.compile(r"(?!.*\d\.\.)(?:[^\W\d][\w .-]{0,20}:[\s_.]*)+")
_COUNTER = re.compile(r"\W*[^\W\d]+(?: [^\W\d]+\.?)? [0-9]+ ?(?:of|von|/) ?[0-9]+\W*")
_LABEL = re.compile(r"[^\W\d][\w ./'-]{1,40}?\s*:\s+(?=\S)")
_MOST_OF_VALUE = 6
"""words of the value of a field"""
_ENDS = re.compile(r"[.!?;]\s*$")
_FEW_WORDS = 3
_FOR_PEOPLE = OF_FORMS | {
    "IF",
    "STATE",
    "FAILS",
    "OCCURS",
    "NOT",
    "forbidding",
    "courtesy",
    "again",
    "EVENT",
}
"""what an instruction to people may mention"""
_IN_PLACE = (
    *("IN_BETWEEN", "BETWEEN", "TIME_WORD", "forbidding", "NOT", "home", "HOME", "DOCK", "GO"),
    *("WAIT", "PAUSE", "pronoun", "place"),
)
"""what a text mentions that only says that the robot does not dock in between"""


def evidence(text: ScriptText, found: Mentions, language: Language, clause: bool = False) -> str:
    """Return why a piece, or a clause of one, has no effect; empty if nothing shows that it has
    none."""
    for reason, is_such in _OF_CLAUSES if clause else (*_OF_LINES, *_OF_CLAUSES):
        if is_such(text, found, language):
            return reason
    return ""


def is_name(content: str) -> bool:
    """Return True if a text can be a person's name or initials, perhaps with what the person is."""
    name, _, role = content.strip(" /-").partition(", ")
    plain = len(role.split()) <= _FEW_WORDS and role.replace(" ", "").isalpha() if role else True
    return plain and bool(_INITIALS.fullmatch(name) or _NAME.fullmatch(name))


def _cue(name: str, language: Language) -> re.Pattern[str]:
    return cue_pattern(name, language.prose.cues[name])


def _separates(text: ScriptText, _: Mentions, __: Language) -> bool:
    return _SEPARATOR.fullmatch(text.content) is not None


def _heads(text: ScriptText, found: Mentions, _: Language) -> bool:
    short = len(text.content.split()) <= _MOST_WORDS
    return text.content.isupper() and short and found.only(*OF_FORMS)


def _answers(text: ScriptText, _: Mentions, language: Language) -> bool:
    said = re.split(r"[\s]*[.!,]+\s*", text.content.strip(" .!,"))
    return all(_cue("answer", language).fullmatch(part) is not None for part in said)


def _wonders(text: ScriptText, found: Mentions, language: Language) -> bool:
    """`Sure, what should it look at?`"""
    begun = text.content
    answer = _cue("answer", language).match(begun)
    begun = begun[answer.end() :].lstrip(" ,.-") if answer is not None else begun
    asks = _cue("wondering", language).match(begun) is not None
    return asks and text.is_question and found.only(*OF_FORMS, "SHOULD", "IF", "question")


def _for_people(text: ScriptText, found: Mentions, language: Language) -> bool:
    """`Ping me if it gets stuck`"""
    told = _cue("people", language).match(text.content)
    return told is not None and found.only(*_FOR_PEOPLE)


def _states(text: ScriptText, found: Mentions, language: Language) -> bool:
    """A fact about a thing that is none of the mission's, which asks for nothing: `The crane is at
    the dock`, `as announced, the demonstration takes place in the yard`."""
    content = text.content
    if _cue("asking", language).search(content) is not None:
        return False
    if _cue("of_others", language).match(content) is not None:
        return found.only(*OF_FORMS, "place", "home", "start", "past", "last", "later")
    lead_in = _LEAD_IN.match(content)
    for begun in (0, lead_in.end() if lead_in is not None else 0):
        begins = _cue("subject", language).match(content, begun)
        verb = begins and _cue("stating", language).search(content, begins.end())
        if begins and verb and found.only("pronoun", "measuring"):
            return any(begins.end() <= w.start < verb.start() for w in found.unknown)
    return False


def _refers(text: ScriptText, found: Mentions, language: Language) -> bool:
    """`Same list as below please`"""
    return _cue("referring", language).search(text.content) is not None and not found.mentions


def _labels(text: ScriptText, found: Mentions, _: Language) -> bool:
    """`Name:      Time:`"""
    return _BLANK_LABELS.fullmatch(text.content) is not None and found.only(*OF_FORMS)


def _idle_fields(text: ScriptText, found: Mentions, language: Language) -> bool:
    """`Team: Blue      Trial: 2`"""
    labels = cue_pattern("labels", language.prose.form["labels"])
    heads = [part.partition(":") for part in re.split(r"\s{2,}", text.content)]
    idle = all(colon and labels.fullmatch(label.strip()) for label, colon, _ in heads)
    return idle and not found.has("checkpoints", "place")


def _counts(text: ScriptText, found: Mentions, _: Language) -> bool:
    """`Item 2 of 3`, `Page 1 / 2`"""
    return _COUNTER.fullmatch(text.content) is not None and found.only(*OF_FORMS, "STEP")


def _has_no_field(text: ScriptText, found: Mentions, language: Language) -> bool:
    """`Status: OPEN`: a label that no field has, and a value, which name nothing of a mission; no
    legend: `Black dot: chosen`."""
    label = _LABEL.match(text.content)
    if cue_pattern("legend", language.prose.form["legend"]).search(text.content) is not None:
        return False
    value = text.content[label.end() :] if label is not None else ""
    short = 0 < len(value.split()) <= _MOST_OF_VALUE and not _ENDS.search(value)
    return short and found.only(*OF_FORMS - {"MEASURE", "BE_MEASURED", "question"})


def _is_none(text: ScriptText, found: Mentions, language: Language) -> bool:
    """`None open`"""
    nothing = cue_pattern("nothing", language.prose.form["nothing"]).match(text.content)
    short = len(text.content.split()) <= _FEW_WORDS
    return nothing is not None and short and found.only(*OF_FORMS)


def _spares(text: ScriptText, found: Mentions, language: Language) -> bool:
    """`No need to go upstairs`, `between the rounds it does not dock`"""
    if _cue("needless", language).match(text.content) is not None:
        return found.only("leave_out", "GO", "forbidding")
    docks = [m for m in found.of("place") if isinstance(m.value, DockLocation)]
    homewards = docks or found.has("home", "HOME", "DOCK")
    between = found.has("IN_BETWEEN", "BETWEEN", "TIME_WORD") and len(docks) == len(
        found.of("place")
    )
    return bool(homewards) and between and found.has("forbidding", "NOT") and found.only(*_IN_PLACE)


_Test = Callable[[ScriptText, Mentions, Language], bool]
_OF_LINES: tuple[tuple[str, _Test], ...] = (
    ("a separator", _separates),
    ("a heading", _heads),
    ("an answer", _answers),
    ("a question that names nothing of the mission", _wonders),
    ("a field that a person fills in", _labels),
    ("a field that a mission does not have", _idle_fields),
    ("a field that a mission does not have", _has_no_field),
    ("a number of a part of the sheet", _counts),
    ("an entry that there is none", _is_none),
    ("a statement of what is not needed", _spares),
)
_OF_CLAUSES: tuple[tuple[str, _Test], ...] = (
    ("for people, not for the robot", _for_people),
    (STATEMENT, _states),
    ("a reference to the lines below", _refers),
)
