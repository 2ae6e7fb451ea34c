"""Evidence from where a piece stands that it has no effect: an entry of a log, a heading over
numbered items, words that announce a list, the name of the document, a signature."""

import re
from contextlib import suppress
from functools import cached_property
from itertools import pairwise

from argo_compiler.script.documents.signs import CLOCK
from argo_compiler.script.documents.source import RefusedError, ScriptText
from argo_compiler.script.layout.asides import Asides
from argo_compiler.script.parsing.script import Piece, Script
from argo_compiler.script.proposals.composing import Composer
from argo_compiler.script.proposals.evidence import is_name, names_points, row_evidence
from argo_compiler.script.proposals.mentions import OF_FORMS, Mentions, mentions_in
from argo_compiler.script.sentences.words.lexicon import expand
from argo_compiler.script.sentences.words.loading import pattern
from argo_compiler.script.sentences.words.prose import phrase_pattern
from argo_compiler.script.sentences.words.without_effect import MISPLACED
from argo_compiler.script.sentences.words.word import VERBS

_FIRST = 4
"""pieces of a letter in which a name alone is a greeting"""
LOGGED = "an entry of a log"
SIGNED = "a signature"
_LAST = 3
"""pieces at the end of a script in which a name alone is a signature"""
_GREETED = re.compile(r"[^\W\d_a-zäöü][^\W\d_A-ZÄÖÜ]+,")
_OF_NAMES = frozenset(["WORD", "SIGN", "UNIT", "UNIT_S"])
"""types of words that initials and names may be taken for"""
_EXTENSION = re.compile(r"[\s,/]+\(?(?:ext|tel|phone|app)\.? ?[\d -]+\)?$", re.IGNORECASE)
_SIGNED = re.compile(r"\s+(?:\d{1,2}[./]\d{1,2}\.?(?:\d{4}|\d\d)?|\d{1,2}:\d{2})$")
"""a date or a time of day behind a name with initials"""
_AT = re.compile(r",\s\d{1,2}:\d{2}$")
_INITIAL = re.compile("[A-Z]")
_INITIALS = re.compile(r"[A-ZÄÖÜ]\.")
_WORDS = re.compile(r"[\w'-]+")
_LONGEST_ROLE = 6
"""words of a line below a name: `Production Supervisor, Train 2`"""
_LOGGED = re.compile(rf"(?:\d{{4}}-\d\d-\d\d\s+)?(?:{CLOCK.pattern})")
_VALUE = re.compile(r"\d[.,]\d")
_OF_ENTRIES = OF_FORMS | {"DURATION", "ALL", "everything", "FLOOR", "LETS_GO", "START", "UNIT_S"}
"""what an entry of a log may mention"""
_SECTION = re.compile(r"\s*(\d{1,2})[.)]?\s+(?=[^\W\d])")
_SUBSECTION = re.compile(r"\s*(\d{1,2})\.1[.)]?\s")
_IN_SECTION = re.compile(r"\d{1,2}(?:\.\d{1,2})+[.)]?\s+")
_IN_HEADINGS = OF_FORMS | {"STEP", "start", "home"}
_ANNOUNCING = frozenset(
    ["DO_FOLLOWING", "MEASURE", "BE_MEASURED", "measuring", "REPEAT", "pronoun", "TIME_WORD"]
) | {"OF", "limit", "question"}
"""what words that announce a list may mention"""
_OF_MANNERS = ("ly", "wise", "wards")
"""how words end that may say how something is done"""
_LONGEST_NAME = 12
"""words of the name of a document"""
_NUMBER_OF_DOCUMENT = r"\s*(?:no\.?|nr\.?|#)?\s*\d+\w?(?!\w|-\d)(?:\s*(?:of|von|/)\s*\d+)?"
_OBJECTS = frozenset(["KIND", "ALL", "HASH", "NUMBER", "IDENT"])
"""types of words behind the verb of an order"""
_BRACKETS = re.compile(r"\([^()]*\)")
_CALENDAR = re.compile(r"\b(?:week|wk|kw)\.? ?\d{1,2}\b", re.IGNORECASE)
_STEP_MARK = re.compile(r"\s*(?:\d{1,3}[.):]|[a-z]\))\s*")
_COMPOUND = re.compile(r"\w-[a-zäöüß]")
"""two words in one, of which the second is no name"""
_CODE = re.compile(r"\b[A-Z]{1,4}-?\d+\b|\b(?:rev|issue|page|form|no)\b", re.IGNORECASE)


class Neighbours:
    """The pieces of a script, by which each of them is told. Mutable: headings are noted
    one after the other."""

    def __init__(self, script: Script, composer: Composer) -> None:
        self.script = script
        self.composer = composer
        self.understanding = composer.understanding
        self.form = composer.understanding.language.prose.form
        self.asides: dict[int, str] = {}
        """why pieces before have no effect, by their number"""
        self.asked = False
        """whether a piece before asks for something"""
        self._in_log = False

    def note(self, i: int, aside: str, asks: bool) -> None:
        """Note what a piece is taken for, and whether it asks for something."""
        self.asides[i] = aside
        self.asked = self.asked or asks

    def reason(self, i: int, text: ScriptText) -> str:
        """Return why a piece has no effect; empty if nothing around it shows that."""
        piece = self.script.pieces[i]
        row = self.script.rows.get(piece.text.first)
        found = mentions_in(text, self.understanding)
        if self._is_entry(i, text, found):
            return LOGGED
        if i < _FIRST and _GREETED.fullmatch(text.content):
            return "a greeting"
        if self._is_signature(i, text):
            return SIGNED
        if row is not None and (row.doubt or row.box is not None or row.is_heading):
            return ""
        excludes = Asides(self.understanding).sets_aside(text)  # `Superseded by sheet 2`
        excludes = excludes or self._over_fields(text)
        excludes = excludes or self.composer.with_names(text) is not text  # `R 18`
        heads = self._is_section(text, found) or self._names_document(text)
        if not excludes and (heads or self._heads(text, found)):
            return "a heading"
        if self._announces(i, text):
            return "an announcement of the lines below"
        if row is not None:
            part = _IN_SECTION.match(text.content)
            inner = text[part.end() :] if part is not None else text
            return row_evidence(inner, self.understanding, part is not None)
        return ""

    # ---- logs

    def note_heading(self, piece: Piece) -> None:
        """Note whether the lines below a piece are those of a log."""
        content = piece.text.content
        if content.isupper() and piece.text.first not in self.script.rows:
            logs = phrase_pattern(self.form["logs"])
            self._in_log = logs.fullmatch(content.strip(" :")) is not None

    @cached_property
    def is_log(self) -> bool:
        """True for a log: by its first line, and by lines with a time of day that say what was
        read, or who handed over. These times are no times of a plan."""
        source = self.script.source
        first = next((line for line in source.lines if line.strip()), "")
        title = phrase_pattern(f"{self.form['logs']} | {self.form['log_titles']}")
        if title.search(first) is None or CLOCK.match(first):
            return False
        handover = phrase_pattern(self.form["handover"])
        for number, line in enumerate(source.lines, start=1):
            if CLOCK.match(line.lstrip(" -*")):
                found = mentions_in(source.line_text(number).strip(), self.understanding)
                read = found.has("QUANTITY") and found.has("checkpoints")
                if handover.search(line) or (read and found.only(*_OF_ENTRIES, "checkpoints")):
                    return True
        return False

    def _is_entry(self, i: int, text: ScriptText, found: Mentions) -> bool:
        """Return True for an entry of what was: `18:20 pump B tripped`, `21:30 R9 found at 20
        deg`; one that names a checkpoint has to have what was read."""
        at = _LOGGED.match(text.content)
        goes_on = self._same_line(i - 1) and self.asides.get(i - 1) == LOGGED
        if (at is None and not goes_on) or text.content.endswith(":"):
            return False
        behind = text.content[at.end() :] if at is not None else ""
        read = found.has("QUANTITY", "past") or _VALUE.search(behind)
        if self._in_log and at is not None:
            return bool(read) or not found.has("checkpoints")
        if not self.is_log or not found.only(*_OF_ENTRIES, "checkpoints", "forbidding", "start"):
            return False
        denied = {text.content[m.start : m.end].lower() for m in found.of("forbidding")}
        if not denied <= {*expand(self.form["none_of"])}:
            return False
        asking = self.understanding.language.prose.cues["asking"]
        asked = {m[0].lower() for m in phrase_pattern(asking).finditer(text.content)}
        if asked - {*expand(self.form["machine"])}:
            return False
        return bool(read) or not (asked or found.has("checkpoints", "MEASURE"))

    def _same_line(self, i: int) -> bool:
        """Return True if a piece and the one behind it stand in the same line."""
        pair = self.script.pieces[i : i + 2] if i >= 0 else ()
        lines = {p.text.source.line_at(p.text.first) for p in pair}
        return len(pair) == 2 and len(lines) == 1

    # ---- headings

    @cached_property
    def _sections(self) -> frozenset[str]:
        """The numbers of headings such as `2 Preparation` over items such as `2.1`."""
        lines = self.script.source.lines
        items = {m[1] for line in lines if (m := _SUBSECTION.match(line))}
        return frozenset(items & {m[1] for line in lines if (m := _SECTION.match(line))})

    def _is_section(self, text: ScriptText, found: Mentions) -> bool:
        """Return True for `2 Preparation` where the items below are `2.1` and `2.2`, and for a
        single word with a number such as theirs."""
        number = _SECTION.match(text.content)
        if number is None or not self._sections or names_points(found):
            return False
        single = len(text.content.split()) == 2 and not found.has("MEASURE")
        one_way = found.has("start") != found.has("home")
        verb = found.has("MEASURE", "BE_MEASURED") and bool(found.unknown)
        fits = found.only(*_IN_HEADINGS, "checkpoints") and not (one_way or verb)
        return fits and (number[1] in self._sections or single)

    def _names_document(self, text: ScriptText) -> bool:
        """Return True for a line such as `ROUND SHEET RS-07` above all that is asked for."""
        content = _BRACKETS.sub("", text.content)
        if len(content.split()) > _LONGEST_NAME or content.endswith((".", ":", "?")):
            return False
        documents = phrase_pattern(self.form["documents"])
        named = documents.search(content)
        head = content.split("  ")[0]
        prose = self.understanding.language.prose
        determined = phrase_pattern(prose.determiner).search(content)
        types = self.understanding.types(text)
        orders = any(a in VERBS and b in _OBJECTS for a, b in pairwise(types))
        before = content[: named.start()] if named is not None else ""
        prepositions = phrase_pattern(prose.preposition).finditer(before)
        refers = any(found.end() == len(before.rstrip()) for found in prepositions)
        amounts = {"DURATION", "QUANTITY", "TIMES", "ALL"} & {*types}
        if determined or orders or amounts or refers or types[:1] == ("MEASURE",):
            return False
        numbered = re.compile(documents.pattern + _NUMBER_OF_DOCUMENT, re.IGNORECASE)
        number = numbered.search(text.content)
        coded = number is not None or _CODE.search(content) is not None
        if named is None or not (head.isupper() or (coded and "," not in content)):
            return False
        rest = text if number is None else text.without(*number.span())
        found = mentions_in(rest, self.understanding)
        named_only = (*OF_FORMS, "REPEAT", "STEP", "checkpoints", "UNIT_S", "BEFORE", "FLOOR")
        return not self.asked and found.only(*named_only) and not self._is_on_site(found)

    def _heads(self, text: ScriptText, found: Mentions) -> bool:
        """Return True for `Round`, or `What the robot does when something happens`, in a line by
        itself between a blank one and others."""
        source, content = text.source, text.content
        number = source.line_at(text.first)
        above, below = (
            source.lines[n - 1].strip() if 0 < n <= len(source.lines) else ""
            for n in (number - 1, number + 1)
        )
        alone = source.lines[number - 1].strip() == content and not above and bool(below)
        if not alone or content[-1] in ".!?" or len(content.split()) > _LONGEST_NAME:
            return False
        prose = self.understanding.language.prose
        if phrase_pattern(self.form["explaining"]).match(content):
            return found.only(*OF_FORMS, "OCCURS", "forbidding")
        section = phrase_pattern(prose.section).fullmatch(content)
        return section is not None and found.only(*OF_FORMS, "STEP")

    def stands_over_points(self, i: int) -> bool:
        """Return True for a line with a colon at its end over one that names checkpoints and has
        no verb: `Team A takes:` over `#1, #4`."""
        pair = self.script.pieces[i : i + 2]
        if len(pair) < 2 or not pair[0].text.content.endswith(":"):
            return False
        lines = [self.script.source.line_at(piece.text.first) for piece in pair]
        found = mentions_in(pair[1].text, self.understanding)
        verb = found.has("MEASURE", "BE_MEASURED")
        return lines[1] == lines[0] + 1 and names_points(found) and not verb

    def _over_fields(self, text: ScriptText) -> bool:
        """Return True for a line that is cut as the next one is: `what; times` over `R31; 2`."""
        lines = self.script.source.lines
        number = self.script.source.line_at(text.first)
        pair = lines[number - 1 : number + 1]
        counts = [[line.count(sign) for line in pair] for sign in ";|\t"]
        return any(len(some) > 1 and some[0] == some[1] > 0 for some in counts)

    def _is_on_site(self, found: Mentions) -> bool:
        """Return True if a text names a checkpoint that the site has."""
        for mention in found.of("checkpoints"):
            if names_points(Mentions((mention,), ())):
                with suppress(RefusedError):
                    if self.composer.known.checkpoints([mention]):
                        return True
        return False

    def _announces(self, i: int, text: ScriptText) -> bool:
        """Return True for a request that says no more than that a list follows: `For the tank test
        please set the robot up like this:`, if the next piece is of a list."""
        at = _LOGGED.match(text.content) if self.is_log else None
        text = text if at is None else text[at.end() :].strip()
        week = _CALENDAR.search(text.content)
        text = text if week is None else text.without(*week.span())
        found = mentions_in(text, self.understanding)
        below = self.script.pieces[i + 1 : i + 2]
        excludes = Asides(self.understanding).sets_aside(text)
        if not below or excludes or names_points(found):
            return False
        further = any(m.value != "DAY" for m in found.of(MISPLACED))
        if further or not found.only(*_ANNOUNCING, MISPLACED, "checkpoints"):
            return False
        content = text.content
        pointing, manner, doing, others, robot = (
            phrase_pattern(self.form[name]).search(content)
            for name in ("pointing", "manner", "doing", "through_others", "machine")
        )
        colon = content.rstrip().endswith(":")
        words = [content[w.start : w.end] for w in found.unknown]
        if manner or any(word.endswith(_OF_MANNERS) for word in words):
            return False
        if not (pointing or colon) or not (doing or (robot and colon)):
            return False
        nouns = self.understanding.language.lexicon.verbs_first and any(
            word[0].isupper() for word in words[1:]
        )
        if robot is None and (others or nouns):
            return False  # `please have Petra do these:`
        if robot is None and "courtesy" not in found.joining:
            return False  # `the day shift reads these:`
        if found.has("checkpoints") and pointing is None:
            return False
        limits = {content[m.start : m.end].lower() for m in found.of("limit")}
        if limits and (pointing is None or not limits <= {pointing[0].lower(), "below"}):
            return False
        listed = self.script.rows.get(below[0].text.first)
        next_text = below[0].text if listed is None else listed.place
        return mentions_in(next_text, self.understanding).has("checkpoints", "place", "start")

    # ---- names

    def _is_plural(self, word: str) -> bool:
        """Return True for several of what the language knows: `Pressures`."""
        known = self.understanding.known | self.understanding.language.prose.words
        ends = re.match(r"(.{3,}?)(?:s|e|en|n)$", word.lower())
        return ends is not None and ends[1] in known

    def _is_signature(self, i: int, text: ScriptText) -> bool:
        """Return True for a name at the end of the script, below the end of a letter, or of one
        that the header names, and for the time behind initials."""
        pieces = self.script.pieces
        if CLOCK.fullmatch(text.content) and i > 0:
            before = pieces[i - 1].text
            same_line = text.source.line_at(before.first) == text.source.line_at(text.first)
            return same_line and self.asides.get(i - 1) == SIGNED
        content = text.content
        if _INITIAL.fullmatch(content) and self._same_line(i):
            return is_name(_SIGNED.sub("", pieces[i + 1].text.content))
        header = text.source.lines[:_FIRST]
        below_name = i > 0 and self.asides.get(i - 1) == SIGNED
        closed = below_name or (i > 0 and self.asides.get(i - 1) == "the end of a letter")
        roles = phrase_pattern(self.form["positions"])
        if closed and roles.search(content) and len(content.split()) <= _LONGEST_ROLE:
            return mentions_in(text, self.understanding).only("PERSON", "NUMBER")
        line_start = text.source.text[: text.first].rpartition("\n")[2]
        phases = pattern(r"\b<phases>\b")
        if _STEP_MARK.fullmatch(line_start) or _COMPOUND.search(content) or phases.search(content):
            return False  # `3. Close-out`
        line = line_start + content
        initials = _INITIALS.match(line.strip()) is not None
        behind = _EXTENSION.search(content) or (_SIGNED if initials else _AT).search(content)
        name = text if behind is None else text[: behind.start()]
        name = name[: len(name.content.rstrip(" )"))]
        found = mentions_in(name, self.understanding)
        whole = is_name(name.content) and found.only("UNIT", "UNIT_S", "MEASURE", "PERSON")
        name = name[: len(name.content.partition(",")[0])]
        if not whole or not {*self.understanding.types(name)} <= _OF_NAMES:
            return False
        words = {*_WORDS.findall(name.content)}
        above = text.source.lines[: text.source.line_at(text.first) - 1]
        apart = len(words) > 1 or initials or not above or not above[-1].strip()
        apart = apart and not any(map(self._is_plural, words))
        return (
            closed
            or (i >= len(pieces) - _LAST and apart)  # `Pressures` below `Check valve R7` is none
            or any(words <= {*_WORDS.findall(line)} and ":" in line for line in header)
        )
