"""Positive evidence that a piece has no effect: what it is, and that it names nothing of a mission.

A piece that is only unknown is never set aside.
"""

import re
import unicodedata
from collections.abc import Callable, Mapping

from argo_compiler.script.documents.source import ScriptText
from argo_compiler.script.proposals.mentions import OF_FORMS, Mentions, mentions_in
from argo_compiler.script.sentences.tree.nouns import Labelled
from argo_compiler.script.sentences.tree.places import DockLocation
from argo_compiler.script.sentences.understanding import Understanding
from argo_compiler.script.sentences.words.language import Language
from argo_compiler.script.sentences.words.loading import pattern
from argo_compiler.script.sentences.words.prose import PhrasePattern, either, phrase_pattern

STATEMENT = "a statement that names nothing of the mission"
_SEPARATOR = re.compile(r"\W*([-=_*~])\1{2,}.*?\1{3,}\W*")
_INITIALS = re.compile(r"(?:[A-ZÄÖÜ]\.?\s?){2,3}")
_NAME = re.compile(r"(?:[^\W\d_a-zäöü][\w'-]*\.?\s?){1,3}")
_LEAD_IN = re.compile(r"[^,]{3,60},\s+")
_TICKS = re.compile(r"[✓✔✗✘☑☒☐□•●○]")
_MOST_WORDS = 6
"""of a heading in capitals"""
_BLANK_LABELS = re.compile(r"(?!.*\d\.\.)(?:[^\W\d][\w .-]{0,20}:[\s_.]*)+")
_COUNTER = re.compile(r"\W*[^\W\d]+(?: [^\W\d]+\.?)?:? [0-9]+ ?(?:of|von|/) ?[0-9]+\W*")
_NUMBERS = re.compile(r"\s*#?[1-9]\d{0,2}(?:\s*(?:,|;|/|&|\+|and|und)\s*#?\d{1,3})*\s*")
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
    "IF_ONLY",
}
"""what an instruction to people may mention"""
_OF_CROWDS = ("ALL", "KEEP_ORDER", "WAIT", "REPEAT", "BEFORE", "AFTER", "STEP", "DURATION")
"""what a text about people may mention besides"""
_CODE = r"(?:#|no\.?|nr\.?)?\s*(?:[A-Z]{2,}[-_ ]?\d[\w/-]*|\d{4,})"
_DATED = r"\d{1,2}\s?[./]\s?\d{1,2}[./]?(?:\d{2,4})?|\d{4}-\d\d-\d\d|[a-z]+[._][a-z]+"
"""a date, or the name of a user"""
_LETTERED_BLANKS = re.compile(r"\s*:\s*(?:[a-z0-9]{1,2}[).]\s*_{2,}\s*[^\s_]{0,4}\s*)+")
_AMOUNTS = re.compile(r"[\s|;:]*[\d.,]+[\s|;_.]*")
_FEWEST_HEADINGS = 3
_IN_PLACE = (
    *("IN_BETWEEN", "BETWEEN", "TIME_WORD", "forbidding", "NOT", "home", "HOME", "DOCK", "GO"),
    *("WAIT", "PAUSE", "pronoun", "place"),
)
"""what a text mentions that only says that the robot does not dock in between"""

_NAMED_BEFORE = r"(.*[^\W_][)\]]?)(?:\s*[-–—:,;=(]{1,3}\s*|\s+)"
"""what stands before `N/A` in a cell"""


def evidence(text: ScriptText, found: Mentions, language: Language, clause: bool = False) -> str:
    """Return why a piece, or a clause of one, has no effect; empty if nothing shows that it has
    none. What says that something is wrong, or of the order, has no such evidence."""
    if pattern(r"\b(?:<overturning>|<turning>)\b").search(text.content) is not None:
        return ""
    for reason, is_such in _OF_CLAUSES if clause else (*_OF_LINES, *_OF_CLAUSES):
        if is_such(text, found, language):
            return reason
    return ""


def is_name(content: str) -> bool:
    """Return True if a text can be a person's name or initials, perhaps with what the person is."""
    name, _, role = content.strip(" /-").partition(", ")
    plain = len(role.split()) <= _FEW_WORDS and role.replace(" ", "").isalpha() if role else True
    return plain and bool(_INITIALS.fullmatch(name) or _NAME.fullmatch(name))


def missing_reading(content: str, form: Mapping[str, str]) -> str:
    """Return `N/A`, or a dash, that stands behind a name where a reading belongs, `R12 - N/A`; not
    one of several answers, `OK / Not OK / N/A`."""
    found = re.fullmatch(
        rf"{_NAMED_BEFORE}({either(form['nothing'])})[\s.)]*", content, re.IGNORECASE
    )
    answers = phrase_pattern(form["furniture"])
    if found is None or any(answer.end() == found.end(1) for answer in answers.finditer(found[1])):
        return ""
    return found[2]


def names_points(found: Mentions) -> bool:
    """Return True if a text names checkpoints by number or name, rather than a kind of them."""
    return any(
        isinstance(noun, Labelled) for mention in found.of("checkpoints") for noun in mention.nouns
    )


def row_evidence(text: ScriptText, understanding: Understanding, numbered: bool) -> str:
    """Return why a row of a sheet has no effect; `numbered`: its number, such as `2.1`, is cut off,
    and the rest may be a sentence."""
    found, language = mentions_in(text, understanding), understanding.language
    tests = (*_OF_ROWS, *_OF_CLAUSES) if numbered else _OF_ROWS
    return next((reason for reason, is_such in tests if is_such(text, found, language)), "")


def _cue(name: str, language: Language) -> PhrasePattern:
    return phrase_pattern(language.prose.cues[name])


def _separates(text: ScriptText, _: Mentions, __: Language) -> bool:
    return _SEPARATOR.fullmatch(text.content) is not None


def _heads(text: ScriptText, found: Mentions, _: Language) -> bool:
    short = len(text.content.split()) <= _MOST_WORDS
    return text.content.isupper() and short and found.only(*OF_FORMS)


def _signs(text: ScriptText, _: Mentions, __: Language) -> bool:
    """A picture such as a raised thumb; not a tick."""
    content = text.content.replace(" ", "")
    pictures = all(unicodedata.category(c) in ("So", "Sk", "Cf", "Mn") for c in content)
    return pictures and bool(content) and _TICKS.search(content) is None


def _greets(text: ScriptText, found: Mentions, language: Language) -> bool:
    """`thank youuu`, `tx, Bo`, `no rush`: courtesies, however lengthened, perhaps with a name."""
    prose = language.prose
    if found.has("checkpoints", "place") or len(text.content.split()) > _MOST_WORDS:
        return False
    phrases = " | ".join((prose.greeting, prose.closing, prose.form["chatter"]))
    courtesies = phrase_pattern(_squeezed(phrases))
    words = re.sub(r"[^\w\s,'|/-]", " ", text.content).strip(" ,")
    begun = courtesies.match(_squeezed(words))
    if begun is None:
        return False
    rest = words.split()[len(begun[0].split()) :]
    name = " ".join(rest).strip(" ,/-")
    unknown = {text.content[w.start : w.end] for w in found.unknown}
    return not rest or (
        {*re.findall(r"[\w'-]+", name)} <= unknown and (is_name(name) or len(rest) == 1)
    )


def _squeezed(said: str) -> str:
    """Return phrases in lower case in which no letter is doubled: of `youuu` and `you` the same."""
    return re.sub(r"([^\W\d])\1+", r"\1", said.lower())


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
    content, form = text.content, language.prose.form
    crowd = phrase_pattern(form["crowd"]).match(content)
    if crowd is not None:
        return found.only(*_FOR_PEOPLE - {"MEASURE"}, *_OF_CROWDS)
    called = phrase_pattern(form["calling"]).search(content)
    head = content[: called.start()].strip(" ,:-") if called is not None else ""
    before = phrase_pattern(form["before_call"]).match(head)
    news = phrase_pattern(form["news"]).search(head)
    clauses = _cue("clause", language)
    if called is not None and clauses.search(head + content[called.end() :]) is not None:
        return False  # `photograph it and call me`
    if called is not None and (not head or before or news):
        return found.only(*_FOR_PEOPLE, "BEFORE", "ELSE")
    return _cue("people", language).match(content) is not None and found.only(*_FOR_PEOPLE)


def _states(text: ScriptText, found: Mentions, language: Language) -> bool:
    """A fact about a thing that is none of the mission's, which asks for nothing: `The crane is at
    the dock`, `as announced, the demonstration takes place in the yard`."""
    content = text.content
    if _cue("asking", language).search(content) is not None:
        return False
    if _cue("of_others", language).match(content) is not None:
        return found.only(*OF_FORMS, "place", "home", "start", "past", "last", "later")
    news = phrase_pattern(language.prose.form["news"]).search(content)
    if news is not None and "," not in content:
        alone = _cue("clause", language).search(content, news.end()) is None
        return alone and found.only("again") and bool(found.unknown)
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
    form = language.prose.form
    labels = phrase_pattern(form["labels"])
    also = phrase_pattern(f"{form['labels']} | {form['records']} | {form['runs']}")
    joined = re.sub(r":\s+(?=\S)", ": ", text.content)
    heads = [part.partition(":") for part in re.split(r"\s{2,}", joined)]
    said = [label.strip() for label, _, _ in heads]
    short = len(joined.split()) <= _MOST_OF_VALUE * len(heads) and not found.has("MEASURE", "GO")
    idle = all(colon for _, colon, _ in heads) and (
        all(map(labels.fullmatch, said))
        or (short and len(heads) > 1 and all(map(also.fullmatch, said)))
    )
    return idle and not found.has("checkpoints", "place")


def _counts(text: ScriptText, found: Mentions, _: Language) -> bool:
    """`Item 2 of 3`, `Page 1 / 2`"""
    counted = all(text.content[m.start].lower() in "n#" for m in found.of("checkpoints"))
    whole = _COUNTER.fullmatch(" ".join(text.content.split())) is not None
    return whole and counted and found.only(*OF_FORMS, "STEP", "REPEAT", "checkpoints")


def _has_no_field(text: ScriptText, found: Mentions, language: Language) -> bool:
    """`Status: OPEN`: a label that no field has, and a value, which name nothing of a mission; no
    legend: `Black dot: chosen`."""
    label = _LABEL.match(text.content)
    if label is not None and _NUMBERS.fullmatch(text.content, label.end()) is not None:
        return False  # `Levels: 4, 5`, `Less: 3`
    if phrase_pattern(language.prose.form["legend"]).search(text.content) is not None:
        return False
    value = text.content[label.end() :] if label is not None else ""
    form = language.prose.form
    if pattern(r"\b<driving>\b").search(text.content) is not None:
        return False  # `Speed: slow`
    if label is not None and pattern(r"\b<ordering>\b").search(label[0]) is not None:
        return False  # `Order: C, A, B`
    counts = phrase_pattern(form["rounds_count"]).search(text.content) is not None
    short = 0 < len(value.split()) <= _MOST_OF_VALUE and not (counts or _ENDS.search(value))
    return short and found.only(*OF_FORMS - {"MEASURE", "BE_MEASURED", "question"})


def _is_none(text: ScriptText, found: Mentions, language: Language) -> bool:
    """`None open`"""
    nothing = phrase_pattern(language.prose.form["nothing"]).match(text.content)
    short = len(text.content.split()) <= _FEW_WORDS
    return nothing is not None and short and found.only(*OF_FORMS)


def _registers(text: ScriptText, found: Mentions, language: Language) -> bool:
    """`Ticket #48213`, `Opened by m.oyelaran`, `valid from 01.03`, and such a label alone."""
    label = phrase_pattern(language.prose.form["records"]).match(text.content)
    value = text.content[label.end() :].strip(" .:") if label is not None else ""
    coded = re.fullmatch(f"{_CODE}|{_DATED}", value) is not None
    named = is_name(value) and not found.has("checkpoints", "place")
    return label is not None and (not value or coded or named)


def _totals(text: ScriptText, _: Mentions, language: Language) -> bool:
    """`Total   65   ____`: numbers without a unit."""
    content = text.content.lstrip(" |;")
    label = phrase_pattern(language.prose.form["totals"]).match(content)
    return label is not None and _AMOUNTS.fullmatch(content, label.end()) is not None


def _results(text: ScriptText, _: Mentions, language: Language) -> bool:
    """`Values: a) ____ bar  c) ____ bar`: blanks for what the items above ask for."""
    label = phrase_pattern(language.prose.form["results"]).match(text.content)
    return label is not None and _LETTERED_BLANKS.fullmatch(text.content, label.end()) is not None


def _heads_columns(text: ScriptText, found: Mentions, language: Language) -> bool:
    """`CP EQUIPMENT UNIT NORMAL READING`: headings of columns, of which all but one are known."""
    words = text.content.split()
    known = sum(language.prose.role(word) is not None for word in words)
    capital = all(word[0].isupper() for word in words)
    enough = known >= max(_FEWEST_HEADINGS, len(words) - 1)
    return capital and enough and not names_points(found)


def _is_boilerplate(text: ScriptText, found: Mentions, language: Language) -> bool:
    """`This message may contain confidential information`"""
    phrases = phrase_pattern(language.prose.form["boilerplate"])
    return phrases.match(text.content) is not None and not found.has("checkpoints", "place")


def _scores(text: ScriptText, found: Mentions, language: Language) -> bool:
    """`Penalty: 5 points for each missed checkpoint`"""
    scoring = phrase_pattern(language.prose.form["scoring"]).search(text.content)
    idle = OF_FORMS - {"MEASURE", "BE_MEASURED"} | {"STEP", "each", "EVERY", "checkpoints"}
    return scoring is not None and found.only(*idle) and not names_points(found)


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
    ("a picture", _signs),
    ("a courtesy", _greets),
    ("a standing phrase of letters", _is_boilerplate),
    ("a field that a mission does not have", _registers),
    ("the headings of columns", _heads_columns),
    ("a question that names nothing of the mission", _wonders),
    ("a field that a person fills in", _labels),
    ("a field that a mission does not have", _idle_fields),
    ("a field that a mission does not have", _has_no_field),
    ("a number of a part of the sheet", _counts),
    ("an entry that there is none", _is_none),
    ("a statement of what is not needed", _spares),
)
_OF_ROWS: tuple[tuple[str, _Test], ...] = (
    ("a field that a mission does not have", _idle_fields),
    ("a field that a mission does not have", _registers),
    ("a number of a part of the sheet", _counts),
    ("a total", _totals),
    ("a field that a person fills in", _results),
    ("a rule of scoring", _scores),
)
_OF_CLAUSES: tuple[tuple[str, _Test], ...] = (
    ("a rule of scoring", _scores),
    ("for people, not for the robot", _for_people),
    (STATEMENT, _states),
    ("a reference to the lines below", _refers),
)
