"""What in a script asks for nothing: greetings, remarks, titles, reasons, words such as `tonight`.

Whatever is taken for such is a note, so that nothing is left out without a word; what may ask for
something after all is a warning or an error.
"""

import re
from collections.abc import Iterator
from functools import cache
from itertools import islice, pairwise

from argo_compiler.script.documents.signs import CLOCK
from argo_compiler.script.documents.source import Diagnostics, ScriptText, join
from argo_compiler.script.sentences.grammar.parser import StumbleError
from argo_compiler.script.sentences.understanding import Understanding
from argo_compiler.script.sentences.words.lexer import says_order
from argo_compiler.script.sentences.words.lexicon import expand
from argo_compiler.script.sentences.words.loading import pattern
from argo_compiler.script.sentences.words.prose import Prose, either, phrase_pattern
from argo_compiler.script.sentences.words.word import VERBS, Word

_MANNERS = frozenset(
    [
        *("DURATION", "SPEED", "TIMES", "AT_MOST", "MOST_TIME", "MOST_TIMES", "WITHIN", "LATEST"),
        *("EARLIEST", "IF_TIME", "ANY_ORDER", "THIS_ORDER", "RETRY", "MAX_DURATION", "BACK_IN"),
        *("PRIORITY", "RANKED", "BY_IMPORTANCE", "ENDLESS", "FINISHING", "STOPPING", "SPARE"),
        *(
            "REVERSED",
            "IN_CIRCLES",
            "PREFERABLY",
            "LEAVE_OUT",
            "ORDER_FREE",
            "ROUND_DRIVEN",
            "EXCEPT",
            "CANNOT",
        ),
    ]
)
"""how, when and how often"""
_ASKING = _MANNERS | {
    *("IF", "IF_ONLY", "UNLESS", "ELSE", "NOT", "UNTIL", "EVERY", "QUANTITY", "AT_LEAST"),
    *("GREATER", "LESS", "BETWEEN", "BE_MEASURED", "FAILS", "OCCURS"),
}
"""words of these types are in no title"""
_TELLING = frozenset(["KIND", "VALUE"])
"""words of these types in a remark may be about checkpoints"""
_NAMED = frozenset(["KIND", "HASH", "STEP", "AREA", "DOCK", "FLOOR"])
_LABELS = frozenset(["NUMBER", "IDENT", "STRING", "HASH"])
_WHOLE = frozenset(["HOME", "END", "ABORT", "GO_ON", "RECHARGE", "PAUSE", "PARK"])
"""verbs that need nothing else"""
_PLACES = frozenset(["AREA", "DOCK", "PLACE", "FLOOR", "FLOOR_NAME", "LPAR", "X"])
"""where one may come from; `from` is no order beside anything else"""
_SINGLE = frozenset((verb,) for verb in VERBS)
_JOINTS = ("JOINT", "NEXT", "AND_", "OR_", "COLON")
_TOKEN = re.compile(r"[\w'-]+|[^\w\s]")
_SAYING = _NAMED | {*VERBS, *_ASKING, "PLACE", "FLOOR_NAME", "EVENT", "IT", "THEM", "ALL"}
_HEADING = frozenset(["WORD", "NUMBER", "ORDINAL", "FLOOR", "FLOOR_NAME", "TIME_WORD", "STEP"])
_FURTHER = frozenset(
    ["TIME_WORD", "ORDINAL", "COLON", "ALL", "BOTH", "EVERYTHING", "BEFORE", "FLOOR", "FLOOR_NAME"]
)
"""words of these types are in no reason; `which hang on floor 2` says which are meant"""
_MOST_REASONS = 3
"""in a sentence"""
_COUNTED = frozenset(
    ["TIMES", "MORE", "DURATION", "QUANTITY", "MOST_TIME", "MOST_TIMES", "FLOOR_NAME", "BOTH"]
)
_AREA = ("AREA", "NUMBER")
_FLOORS = frozenset([("FLOOR", "NUMBER"), ("ORDINAL", "FLOOR"), _AREA])
"""types of words, side by side, that name a floor or an area"""
_OF_FLOOR = frozenset(
    [
        *("FLOOR", "FLOOR_NAME", "NUMBER", "ORDINAL", "ON", "IN", "AT", "COLON", "SIGN"),
        *("KIND", "ALL", "AND_NOUN", "AND_PLACE", "DASH"),
    ]
)
"""words of these types alone say what is read and where, and are no headline"""
_PARTICIPLE = re.compile(
    r"(?!required|selected|planned|scheduled|listed|numbered|unmanned|elevated|detailed|combined)"
    r"\w{4,}ed"
)
"""a word that may say in which state the listed points are: `isolated`"""
_LIKE_NAME = re.compile(r"[A-Za-z]{1,3}[ -]\d+")
_LONGEST_TITLE = 14
"""words"""
_LONGEST_OCCASION = 10
"""words"""
_BRACKETS = re.compile(r"\s*\([^()]*\)")
_PROTOCOL = r"(?:protocol|protokoll)"
"""the last word of a title that is numbered, in all languages"""
_FIGURES = re.compile(r"\d\s*[,;]|[,;]\s*\S{0,6}\s?\d")
"""of coordinates or of a list"""
_DASH = re.compile(r"\s-{1,2}\s")
_CUT = re.compile(r",\s*|\s+")


class Asides:
    """Finds what asks for nothing, and tells what may ask for something after all."""

    def __init__(self, understanding: Understanding) -> None:
        self.understanding = understanding
        self.prose: Prose = understanding.language.prose

    # ---- whole lines

    def is_remark(self, content: str) -> bool:
        """Whether a text is labelled as a remark, `Note: ...`, `(Hint: ...)`, or as a page."""
        labelled = _labelled(self.prose.remark).match(content)
        return labelled is not None or _page(self.prose.page).fullmatch(content) is not None

    def remark(self, text: ScriptText) -> ScriptText:
        """What is said behind the label of a remark."""
        label = _labelled(self.prose.remark).match(text.content)
        return text if label is None else text[label.end() :].strip()

    def opens(self, content: str) -> bool:
        """Whether a line begins as the first or last one of a letter does."""
        return bool(
            phrase_pattern(self.prose.greeting).match(content)
            or phrase_pattern(self.prose.closing).match(content)
        )

    def retracts(self, content: str) -> bool:
        """Return True if a line takes back what stands above it: `sorry, not R25 but R12`."""
        return phrase_pattern(self.prose.cues["retracting"]).match(content) is not None

    def greeting(self, text: ScriptText) -> int:
        """Where a greeting at the beginning of a text ends; 0 if there is none."""
        found = phrase_pattern(self.prose.greeting).match(text.content)
        return 0 if found is None else self._line_of_letter(text, found.end())

    def closing(self, text: ScriptText) -> bool:
        """Whether a text closes a letter."""
        found = phrase_pattern(self.prose.closing).match(text.content)
        whole = len(text.content.strip())
        return found is not None and self._line_of_letter(text, found.end(), whole) == whole

    def _line_of_letter(self, text: ScriptText, start: int, end: int | None = None) -> int:
        if end is None:
            comma = re.search(r"[,!:]|$", text.content[start:])
            assert comma is not None
            end = start + comma.end()
        types = self.understanding.types(text[start:end])
        short = len(text.content[start:end].split()) <= 8
        asks = {*types} & ({*_ASKING, *VERBS, "KIND"} - {"FROM"}) or self.names(text[start:end])
        return end if short and not asks else 0

    def is_small_talk(self, text: ScriptText) -> bool:
        """Whether a sentence is one of those that letters are made of, and no more."""
        found = phrase_pattern(self.prose.small_talk).match(text.content)
        if found is None or self.names(text):
            return False
        return not self.asks(text[found.end() :].strip())

    def is_reason(self, text: ScriptText) -> bool:
        """Whether a part of a sentence says why: `because it was replaced`."""
        return phrase_pattern(self.prose.reason).match(text.content) is not None

    def is_signature(self, text: ScriptText) -> bool:
        """Whether a line behind the end of a letter is a name, an address or the like."""
        named = self.names(text) or "KIND" in self.understanding.types(text)
        return not named and not self.asks(text) and len(text.content.split()) <= 8

    # ---- titles

    def is_title(self, text: ScriptText) -> bool:
        """Whether a line may be the title of a script, or the heading of a part of it."""
        words = text.content.lower().rstrip(":").split()
        if self._lists_kind(text) or self._counts_rounds(text) or self.drives(text):
            return False  # `Gauges: all on floor 1`, `Rounds: 3`, `Speed: slow`
        if _LIKE_NAME.fullmatch(text.content):
            return False  # `R 18`, `Ma 6`
        if ".." in text.content or self.turns(text):
            return False  # `for i in 1..3`, `Floor 3, bottom to top`
        if text.content.endswith(":") and {*words} <= _phrases_of(self.prose.around_reactions):
            return True  # `To be obeyed all the time:`
        short = len(words) <= _LONGEST_TITLE
        behind = text.source.text[text.last + 1 : text.last + 2]
        if not short or behind == "?" or self.asks(text, counted=True):
            return False
        types = self.understanding.types(text)
        stated = "IS" in types and not text.content.endswith(":")  # `The steps are:`
        if stated or ";" in text.content:
            return False  # `Round for three robots; yours is the second part`
        return not self.names_tasks(text) or self._is_headline(text)

    def _lists_kind(self, text: ScriptText) -> bool:
        """Return True for `Gauges: all on floor 1`, `Floor 1: valves`, and for a count: `Number of
        valves: 3`."""
        head, _, rest = text.content.partition(":")
        types = self.understanding.types(text[: len(head)])
        placed = any(pair in _FLOORS for pair in pairwise(types)) or "FLOOR_NAME" in types
        of_floor = placed and "KIND" in self.understanding.types(text[len(head) :])
        return (types[-1:] == ("KIND",) and bool(rest.strip())) or of_floor

    def _counts_rounds(self, text: ScriptText) -> bool:
        head, colon, _ = text.content.partition(":")
        phrases = self.prose.form["rounds_count"]
        return bool(colon) and phrase_pattern(phrases).fullmatch(head.strip()) is not None

    def drives(self, text: ScriptText) -> bool:
        """Return True for a field that says how to drive: `Speed: slow`, `Tempo: langsam`."""
        head, colon, value = text.content.partition(":")
        return bool(colon and value.strip()) and pattern(r"\b<driving>\b").search(head) is not None

    def _is_headline(self, text: ScriptText) -> bool:
        """Return True if a text that names a checkpoint or a floor is only a headline.

        Example: `Leak test at pressure gauge 2`. It has no verb, nothing that leaves out or takes
        back, and the checkpoint stands behind a preposition.
        """
        content = text.content
        types = self.understanding.types(text)
        if content.endswith(".") or not _COUNTED.isdisjoint(types) or _AREA in pairwise(types):
            return False
        if "FLOOR" in types and {*types} <= _OF_FLOOR:
            return False  # `FLOOR 4`, over what is read there; `Floor 2, valves`
        if self.names_checkpoint(text) and not self._of_checkpoint(text):
            return False
        cues = self.prose.cues
        spoken = ("forbidding", "past", "leave_out", "stating", "correction")
        return all(phrase_pattern(cues[name]).search(content) is None for name in spoken)

    def _of_checkpoint(self, text: ScriptText) -> bool:
        """Return True for `Leak test at pressure gauge 2` and `Inspection protocol #47`."""
        content = text.content
        before = f"(?:{either(self.prose.headline_preposition)})"
        if re.search(rf"^[^,:|]*\b{_PROTOCOL}\s*#?\s*\d+$", content, re.IGNORECASE):
            return True
        of = re.search(rf"^[^,:|]*\w (?=(?:{before}) [^,:|]+$)", content, re.IGNORECASE)
        return of is not None and not self.names_checkpoint(text[: of.end()])

    def names_checkpoint(self, text: ScriptText) -> bool:
        """Return True if a text names a checkpoint by its number or name."""
        types = self.understanding.types(text)
        return (
            any(a == "KIND" and b in _LABELS for a, b in pairwise(types))
            or ("HASH", "NUMBER") in pairwise(types)
            or self._has_name(text)
        )

    def has_verb(self, text: ScriptText) -> bool:
        """Return True if a word of a text says what is done, or in which case."""
        return not {*self.understanding.types(text)}.isdisjoint({*VERBS, "IF", "UNLESS"})

    def only_names(self, text: ScriptText) -> bool:
        """Return True for a checkpoint's name without a verb, such as `R12` and `#4 valve R25`."""
        start = min((word.start for word in self.understanding.words(text)), default=0)
        before = text.content[:start].strip()
        article = not before or phrase_pattern(self.prose.determiner).fullmatch(before)
        return bool(article) and self.names_checkpoint(text) and not self.has_verb(text)

    def only_lists_kinds(self, text: ScriptText) -> bool:
        """Return True for kinds or floors that are read: `Floor 2 valves`, `Check the valves on
        floor 2`, `Inspect floor 2`."""
        types = {*self.understanding.types(text)}
        whole = "MEASURE" in types and bool(types & {"FLOOR", "FLOOR_NAME"})
        listed = (whole or "KIND" in types) and types <= _OF_FLOOR | {"MEASURE"}
        return listed and not self.names_checkpoint(text)

    def names_tasks(self, text: ScriptText) -> bool:
        """Return True if a text names a checkpoint, a floor, an area, a time or a count."""
        types = self.understanding.types(text)
        if self.is_explicit_title(text):
            return False
        return (
            self.names_checkpoint(text)
            or not _COUNTED.isdisjoint(types)
            or any(pair in _FLOORS for pair in pairwise(types))
        )

    def _has_name(self, text: ScriptText) -> bool:
        """Return True if a word is a part of a name of the site, such as `R25`."""
        words = (word for word in self.understanding.words(text) if word.type == "IDENT")
        return any(_said(text, word) in self.understanding.names for word in words)

    def stands_for_title(self, text: ScriptText) -> bool:
        """Whether a line over numbered steps, which makes no sense as an order, is a title though
        it has the words of one: `Depressurising line 7`, `Watching the column`."""
        words = self.understanding.words(text)
        found = {word.type for word in words}
        ordered = min(words, key=lambda word: word.start).type in VERBS if words else True
        short = len(text.content.split()) <= _LONGEST_TITLE
        named = (_NAMED - {"STEP"} | {"EVENT", "PLACE", "AREA"}) & found
        return short and "WORD" in found and not (found & _ASKING or named or ordered)

    def is_explicit_title(self, text: ScriptText) -> bool:
        """Whether a title says itself that it is one: `Mission Protocol #2`."""
        return phrase_pattern(self.prose.explicit_title).match(text.content) is not None

    # ---- parts of sentences

    def without(
        self, text: ScriptText, first: bool = False
    ) -> tuple[ScriptText, list[ScriptText]] | None:
        """The text without what asks for nothing, if it makes sense then, and what that is."""
        for rest, aside in self._cut(text, first):
            if not isinstance(self.understanding.read(rest), StumbleError):
                return rest, aside
        return None

    def _is_order(self, text: ScriptText, first: bool) -> bool:
        """Whether what stands behind a heading in its line says what to do; on the first line it
        has to have a verb, as `Mission: 1` and `Protocol: all valves` are titles."""
        types = {*self.understanding.types(text)}
        return bool(types & {*VERBS, "IF", "UNLESS"}) or (
            not first and (self.names(text) or {"ALL", "KIND"} <= types)
        )

    def _cut(self, text: ScriptText, first: bool) -> Iterator[tuple[ScriptText, list[ScriptText]]]:
        content = text.content
        outer, brackets = self._without_brackets(text)
        if brackets:
            yield outer, brackets
        for dash in _DASH.finditer(content):
            aside = text[dash.end() :].strip()
            if not (self.adds(aside) or self._denies(aside)):
                yield text[: dash.start()].strip(), [aside]
        colon = content.find(": ")
        behind_colon = text[colon + 1 :].strip()
        heading = colon > 0 and (
            self.is_small_talk(text[:colon])
            or (self._is_section(text[:colon]) and self._is_order(behind_colon, first))
        )
        if heading:
            yield behind_colon, [text[: colon + 1]]
        occasion = phrase_pattern(self.prose.occasion).match(content)
        if occasion is not None:
            yield from self._behind(text, occasion.end())
        reason = phrase_pattern(self.prose.reason)
        cuts = (cut for cut in _CUT.finditer(content) if reason.match(content, cut.end()))
        for cut in islice(cuts, _MOST_REASONS):
            comma = content.find(",", cut.end())
            end = comma if comma > 0 else len(content)
            named = self.names(text[end:])
            for behind in (end,) if named else (len(content), end):
                aside = text[cut.end() : behind].strip()
                said = aside[len(aside.content.split()[0]) :]
                if not self.asks(said) and not _FURTHER & {*self.understanding.types(said)}:
                    yield join([text[: cut.start()], text[behind:]]), [aside]

    def _behind(
        self, text: ScriptText, start: int
    ) -> Iterator[tuple[ScriptText, list[ScriptText]]]:
        """The text without what it is for, or when: `For the demo on Friday, ...`."""
        for token in islice(_TOKEN.finditer(text.content, start), 1, _LONGEST_OCCASION):
            aside = text[: token.start()].strip()
            types = {*self.understanding.types(aside)}
            rest = text[token.start() :].strip()
            if {*self.understanding.types(rest)} & {"WORD", "SIGN"} or rest.content.strip(
                " .:"
            ).isdecimal():
                continue  # `for i in 1..3`
            if ("AT", "NUMBER") in pairwise(self.understanding.types(aside)):
                continue  # `während du an 1 wartest`
            if "WORD" in types and not types & _SAYING and not self.asks(aside):
                yield rest, [aside]

    def _is_section(self, text: ScriptText) -> bool:
        """Whether a text is the heading of what follows in the same line."""
        words = {*text.content.lower().split()}
        return bool(words & _phrases_of(self.prose.section)) and not (
            {*self.understanding.types(text)} - _HEADING or self.asks(text)
        )

    def _without_brackets(self, text: ScriptText) -> tuple[ScriptText, list[ScriptText]]:
        kept: list[ScriptText] = []
        cut: list[ScriptText] = []
        start = 0
        for found in _BRACKETS.finditer(text.content):
            inner = text[found.start() : found.end()].strip()
            if not any(map(str.isalnum, inner.content)) or inner.content.lower() == "(x)":
                continue  # `(-)`, `(x)` may mean that it is left out, or done
            if (
                self.adds(inner[1:-1])
                or self._denies(inner[1:-1])
                or _FIGURES.search(inner.content)
            ):
                continue
            kept.append(text[start : found.start()])
            cut.append(inner)
            start = found.end()
        kept.append(text[start:])
        return join([part for part in kept if part.content] or kept), cut

    # ---- what may ask for something

    def names(self, text: ScriptText) -> bool:
        """Whether a text names a checkpoint, a starting area or a step."""
        types = self.understanding.types(text)
        labelled = any(a in _NAMED and b in _LABELS for a, b in pairwise(types))
        return labelled or self._has_name(text)

    def asks(self, text: ScriptText, counted: bool = False) -> bool:
        """Whether a text that makes no sense may ask for something; in a title runs and tests may
        be counted: `Team 4, run 2`."""
        types = self.understanding.types(text)
        if _ASKING & {*types} or self.orders(text, counted):
            return True
        if ("HASH", "KIND") in pairwise(types):
            return True  # `no valves today`
        numbered = types[1:3] != ("STEP", "IDENT")  # `Work instruction WI-31` is a title
        if len(types) > 2 and types[0] == "WORD" and types[1] in _NAMED and numbered:
            found = self.understanding.words(text)
            counted = types[1] == "HASH" and text.content[found[1].start] != "#"
            return types[2] in _LABELS and not counted  # `Protocol no. 4` is a title
        return self._has_object(text.content)

    def orders(self, text: ScriptText, counted: bool = False) -> bool:
        """Whether a verb of the robot's stands in a text as it does in an order."""
        nouns = _phrases_of(self.prose.counted) if counted else frozenset()
        found = self.understanding.words(text)
        types = [word.type for word in found]
        for i, type_ in enumerate(types):
            if type_ not in VERBS or (type_ == "FROM" and not _PLACES & {*types}):
                continue
            after = types[i + 1] if i + 1 < len(types) else ""
            named = type_ != "MEASURE" or types[i - 1] == "WORD"  # not `Plan, test 12`
            if i > 0 and after == "NUMBER" and named and _said(text, found[i]) in nouns:
                continue
            joined = i > 0 and (bool(found[i].before) or types[i - 1].startswith(_JOINTS))
            said = text.content[found[i].end :].split()[:1]
            if (i == 0 or joined) and after and said != ["of"]:
                return True
            if (joined and type_ in _WHOLE) or after in _NAMED | _LABELS | {"ALL", "IT"}:
                return True
        return False

    def bids(self, text: ScriptText) -> bool:
        """Whether a remark says what is to be done, or how."""
        types = self.understanding.types(text)
        return bool(_MANNERS & {*types}) or self.orders(text) or types[:1] in _SINGLE

    def sets_aside(self, heading: ScriptText) -> bool:
        """Return True if a heading may exclude the lines below it, always or in some cases."""
        types = self.understanding.types(heading)
        timed = types[:1] in (("BEFORE",), ("AFTER",)) or CLOCK.search(heading.content) is not None
        return timed or _limits(heading, "set_aside", "past")

    def keeps_away(self, heading: ScriptText) -> bool:
        """Return True if a heading may say that others do what is listed below it, or nobody:
        `Petra will do these:`, `Off limits`, `Isolated`."""
        told = pattern(r"\b<keeping_away>\b").search(heading.content) is not None
        told = told or self.turns(heading)
        usual = _phrases_of(self.prose.around_reactions)
        unknown = (w for w in self.understanding.words(heading) if w.type == "WORD")
        states = (_said(heading, word) for word in unknown)
        return told or any(s not in usual and _PARTICIPLE.fullmatch(s) for s in states)

    def turns(self, heading: ScriptText) -> bool:
        """Return True if the lines below may be meant in another order: `from bottom to top`."""
        return pattern(r"\b<turning>\b").search(heading.content) is not None

    def corrects(self, remark: ScriptText) -> bool:
        """Whether a remark may take something back, or say when or how it is done."""
        words = self.understanding.words(remark)
        in_case = phrase_pattern(self.prose.cues["in_case"]).match(remark.content)
        if in_case is not None and ":" in remark.content:
            return True  # `- bei Abweichung: Meldung`
        telling = any(word.type in _TELLING or _is_figure(remark, word) for word in words)
        return telling or self.overturns(remark) or _limits(remark, "set_aside", "correcting")

    def overturns(self, remark: ScriptText) -> bool:
        """Return True if a remark may say that something is wrong, or of the order: `the other way
        round`, `R7 was meant`."""
        return pattern(r"\b<overturning>\b").search(remark.content) is not None

    def orders_row(self, remark: ScriptText) -> bool:
        """Return True if a cell may say when its row is done: `please last`, `then`, `2nd`; not of
        `tap the glass first`, where that is said of something else."""
        content = remark.content
        if says_order(content, self.understanding.language.lexicon):
            return True
        cues = (phrase_pattern(self.prose.cues[name]).search(content) for name in ("first", "last"))
        rests = (remark.without(*found.span()) for found in cues if found is not None)
        return any("WORD" not in self.understanding.types(rest) for rest in rests)

    def ranks(self, text: ScriptText) -> bool:
        """Whether a text says of a kind only when it is done: `The valves come first`."""
        types = self.understanding.types(text)
        words = text.content.strip(" .!:").lower().split()
        ends = {*words[:1], *words[-1:]}
        return (
            types[:1] == ("KIND",)
            and len(types) <= 3
            and {*types[1:]} <= {"BE_MEASURED", "WORD"}
            and not ends.isdisjoint(_phrases_of(self.prose.foremost))
        )

    def adds(self, text: ScriptText) -> bool:
        """Whether a part of a sentence may say something of its order: `(and 4)`, `(go home)`."""
        found = self.understanding.words(text)
        types = [word.type for word in found]
        sides = any(a in ("BEFORE", "AFTER") and b in _NAMED | _LABELS for a, b in pairwise(types))
        opens = bool(found) and (
            found[0].before != ""
            or types[0] in VERBS
            or types[0] == "JOINT"
            or types[0].startswith(("OR_", "AND_"))
        )
        return sides or opens or {*types} <= _LABELS or self.asks(text) or self.names(text)

    def _denies(self, text: ScriptText) -> bool:
        """Return True for `N/A` or a dash, which may mean that something is left out."""
        nothing = phrase_pattern(self.prose.form["nothing"])
        return nothing.fullmatch(text.content.strip(" .")) is not None

    def _has_object(self, content: str) -> bool:
        """Whether an article stands where that of a verb's object does: `send an SMS`."""
        tokens = [token.lower() for token in _TOKEN.findall(content)]
        article, before = _phrases_of(self.prose.determiner), _phrases_of(self.prose.preposition)
        return any(
            token in article
            and after[0].isalpha()
            and last[0].isalpha()
            and last not in before
            and last not in article
            for last, token, after in zip(tokens, tokens[1:], tokens[2:], strict=False)
        )


def ask_of_remark(remark: ScriptText, diagnostics: Diagnostics) -> None:
    """Asks about a remark that may not be one."""
    message = f"`{remark.content}` can be a change, or a remark"
    hint = "write the change into the commands, or remove this"
    diagnostics.error("ambiguous-remark", message, remark.span(), hint)


def _limits(text: ScriptText, *names: str) -> bool:
    """Whether a text has words of these names, or is one that says when something is done."""
    said = "|".join(f"<{name}>" for name in names)
    whole = text.content.strip(" :.!?()*_")
    in_text = pattern(rf"\b(?:{said})\b").search(text.content)
    return in_text is not None or pattern("<in_some_case>").fullmatch(whole) is not None


def _is_figure(text: ScriptText, word: Word) -> bool:
    """Return True for a number in figures, without a unit; not of a heading: `Task 1:`"""
    heading = text.content.endswith(":")
    return word.type == "NUMBER" and text.content[word.start].isdigit() and not heading


def _said(text: ScriptText, word: Word) -> str:
    return text.content[word.start : word.end].lower()


@cache
def _phrases_of(phrases: str) -> frozenset[str]:
    """The phrases that bars separate."""
    return frozenset(expand(phrases))


@cache
def _labelled(labels: str) -> re.Pattern[str]:
    return re.compile(rf"[_(*]*(?:{either(labels)})\s*:", re.IGNORECASE)


@cache
def _page(words: str) -> re.Pattern[str]:
    """`page 2 of 3`."""
    of = r"\s*(?:/|[a-z]+)\s*[0-9]+"
    return re.compile(rf"\W*(?:{either(words)})\s*[0-9]+(?:{of})?\W*", re.IGNORECASE)
