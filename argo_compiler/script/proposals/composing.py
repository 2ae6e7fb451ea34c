"""What a clause proposes: sentences that use all of it that means something.

A proposal never passes over a negation, a condition or a correction. Where parts are left that no
sentence uses, the clause stays open, and what it may become are choices.
"""

import re
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import pairwise

from argo_compiler.base.catalog import CheckpointInfo
from argo_compiler.script.documents.source import RefusedError, ScriptText
from argo_compiler.script.proposals.evidence import evidence, missing_reading
from argo_compiler.script.proposals.frames import Sentences, sentences_of
from argo_compiler.script.proposals.known import Known, is_number
from argo_compiler.script.proposals.mentions import (
    Mention,
    Mentions,
    mentions_in,
)
from argo_compiler.script.proposals.paraphrasing import reads, rephrased, sentence
from argo_compiler.script.sentences.tree.nouns import AllOf, Kind, Nouns, TheOne
from argo_compiler.script.sentences.understanding import Understanding
from argo_compiler.script.sentences.words.prose import phrase_pattern

_EVENTS = ("EVENT", "BATTERY", "FAILS", "OCCURS")
"""what a text mentions before a colon, if what is to be done then stands behind it"""
_MOST_EVENT_WORDS = 7
RETURNING = ("home", "HOME", "DOCK", "END", "ABORT", "WAIT", "PAUSE")
"""kinds of mentions by which a mission ends, or waits"""
_OF_ANY = ("KIND", "VALUE", "STEP")
"""types of words that name any reading, where nothing else names one"""
_COMMA = re.compile(r"\s*[,;:]\s+|\s+-\s+")
_PLAIN = frozenset(
    [
        *("AND_NOUN", "AND_DO", "AND_PLACE", "AND_ON", "NEXT", "COLON", "JOINT", "HE", "NAMELY"),
        *("LPAR", "RPAR", "IS"),
    ]
)
"""words that join others, of which none changes what a whole clause means"""
_BIDDING = ("MEASURE", "BE_MEASURED", "start", "START", "home", "HOME", "END")
"""mentions that ask for something, whatever words of politeness stand beside them"""
_TOWARDS = frozenset(["TO", "IN", "AT", "ON", "FOR"])
"""words that join a place"""
_UNSURE = (
    "measuring",
    "pronoun",
    "last",
    "first",
    "later",
    "again",
    "past",
    "over",
    "limit",
    "LESS",
    "WITHIN",
)
"""mentions beside which a proposal has to be confirmed"""
_LIKE_CHECKS = re.compile(r"(?:Check|Order:|Maximum|Start|Return|End)")
_NUMBERED = re.compile(r"checkpoint (\d+)")
_HOMEWARDS = re.compile(r"Return |End of the mission|Abort")
_LIST = re.compile(r"\s*#?\w*\d(?:(?:\s*[,;/&+]\s*|\s+(?:and|und)\s+|\s+)#?\w*\d)*\W*")
"""names with figures, one after the other: `R25, R12`, `4 and 5`"""
_BACK_TO_ITEM = re.compile(r"\s[a-z]\)?\W*$")
"""a letter at the end of a text may be the item to go back to"""
_CUT_FIGURES = re.compile(r"(?<=\d)[ \t]+(?=\d)")
_CUT_NAME = re.compile(r"\b[A-Za-z]{1,3}([ \t-])\d+\b")
"""letters and figures that may be one name"""
_OF_PASSING = ("leave_out", "NEXT_STEP", "GO_ON", "pronoun", "checkpoints", "STEP", "NUMBER")
"""kinds of mentions of `skip it` and `leave that one out`"""
PASSING_OVER = "If a reading fails, go on with the next checkpoint."
_MOST_CLAUSES = 14
_NO_LISTS = frozenset([("IS",), ("TO",), ("UPTO",)])
"""types of words between two checkpoints that say more than that both are in a list"""
_NO_NAME = re.compile(r"\s+(?:X{1,4}|N{2,3}|_+|\?+|\.{3}|TBD|TBC)\b")
"""what stands for a name that is not known yet"""


@dataclass(frozen=True)
class Proposal:
    """What is proposed for a text; without sentences and without `aside` it stays open."""

    sentences: Sentences = ()
    unused: tuple[str, ...] = ()
    aside: str = ""
    """why the text has no effect"""
    choices: tuple[Sentences, ...] = ()
    """for an open text: what it may become"""
    doubt: str = ""
    """for an open text: what is not clear"""
    differences: tuple[str, ...] = ()
    """what the text says otherwise than the site"""
    ignored: tuple[str, ...] = ()
    """words of a certain proposal that ask for nothing"""
    complete: bool = False
    """for an open text: whether nothing but its choices is to be offered"""
    certain: bool = False
    """whether every word of it is used, so that nobody has to confirm it"""

    @property
    def is_open(self) -> bool:
        """Return True if nothing is proposed."""
        return not (self.sentences or self.aside or self.certain)


def normal_end(checkpoint: CheckpointInfo, name: str) -> str:
    """Return the end of the normal range beyond which a reading is `too_high` or `too_low`."""
    normal = checkpoint.nominal
    return f"{normal.high if name == 'too_high' else normal.low:g}"


class Composer:
    """Proposes sentences for texts, one after the other. Mutable: a pronoun means what was measured
    last."""

    def __init__(self, understanding: Understanding, known: Known) -> None:
        self.understanding = understanding
        self.known = known
        self.before = ""
        """the text before, in words of the language"""
        self.taken_apart = 0
        """characters of texts whose parts were read one by one"""

    def propose(self, text: ScriptText) -> Proposal:
        """Return what a sentence or a line proposes."""
        text = self.with_names(self.understanding.rewritten(text))
        head, colon, names = text.content.partition(":")
        types = {*self.understanding.types(text[: len(head)])} if colon else set()
        listed = types in ({"KIND"}, {"VALUE"}) and _LIST.fullmatch(names) is not None
        if listed and types == {"KIND"}:  # `Valves: R25, R12`
            text = text.without(len(head), len(head) + 1)
        elif listed or (types == {"KIND"} and names.strip(" _.")):
            return Proposal()  # `Levels: 4, 5`, `Gauges: see list`
        found = mentions_in(text, self.understanding)
        reason = evidence(text, found, self.understanding.language)
        if reason:
            return Proposal(aside=reason)
        joint = self.understanding.unfinished(text)
        either = joint is not None and joint.content.lower() in self.understanding.joints("or")
        if either or (text.is_question and not found.has("MEASURE", "BE_MEASURED")):
            return Proposal()  # `R9 as well?`
        if said := self.known.disagreement(found.of("checkpoints")):
            return Proposal(doubt=said)
        if self._may_be_no_list(text, found.of("checkpoints")):
            return Proposal()
        if denial := missing_reading(text.content, self.understanding.language.prose.form):
            return Proposal(doubt=f"`{denial}` can mean that this is left out")
        if self._passes_over(text):
            return Proposal((PASSING_OVER,))
        if self._may_be_case(rephrased(text, self.understanding).text):
            return Proposal()
        before = self.known.state()
        made = self._composed(text, found)
        if made is None or made.unused:
            after = self.known.state()
            self.known.reset(before)
            other = self._readable(text, found) or self._joined(text)
            if other is None:
                self.known.reset(after)
            made = other or made
        if made is None and found.mentions:
            made = self._of_clauses(text, found)
        return made if made is not None else Proposal()

    def with_names(self, text: ScriptText) -> ScriptText:
        """Return a text with names of the site written as one word: `R 18`."""
        for cut in reversed(list(_CUT_NAME.finditer(text.content))):
            if cut[0].replace(cut[1], "").lower() in self.known.names:
                text = text.without(*cut.span(1))
        return text

    def _joined(self, text: ScriptText) -> Proposal | None:
        """Return what a text is with its figures put together, `#1 3` as `#13`, if then number and
        name are of one checkpoint."""
        joined = text
        for cut in reversed(list(_CUT_FIGURES.finditer(text.content))):
            joined = joined.without(*cut.span())
        if joined is text:
            return None
        found = mentions_in(joined, self.understanding)
        with suppress(RefusedError):
            named = [self.known.checkpoints([mention]) for mention in found.of("checkpoints")]
            if len(named) < 2 or any(one != named[0] for one in named) or len(named[0]) != 1:
                return None
            made = self._composed(joined, found)
            return None if made is None else replace(made, certain=False)
        return None

    def _readable(self, text: ScriptText, found: Mentions) -> Proposal | None:
        """Return what a text is in words that the grammar, or a frame, takes."""
        if self._changes(found):
            return None
        said = rephrased(self.within(self._on_event(self._alike(text))), self.understanding)
        if said.text.content == text.content:
            return None
        if reads(said.text, self.understanding):
            return Proposal((sentence(said.text),), said.dropped)
        made = self._composed(said.text, mentions_in(said.text, self.understanding))
        if made is None:
            return None
        return replace(made, unused=(*said.dropped, *made.unused), certain=False)

    def _changes(self, found: Mentions) -> bool:
        """Return True if a text may leave out what is asked for elsewhere: then `skip it unless`
        can't become a check in a case."""
        if not found.has("leave_out"):
            return False
        with suppress(RefusedError):
            named = {c.id for c in self.known.checkpoints(found.of("checkpoints"))}
            return not named.isdisjoint(self.known.asked | self.known.memory.so_far.keys())
        return True

    def _on_event(self, text: ScriptText) -> ScriptText:
        """Return `Gas alarm: go home` as a condition."""
        head, colon, rest = text.content.partition(":")
        found = mentions_in(text[: len(head)], self.understanding)
        short = len(head.split()) <= _MOST_EVENT_WORDS
        fails = self.is_failure(text[: len(head)])
        occurs = fails or (found.has(*_EVENTS) and not found.unknown)
        if not (colon and rest.strip() and short and occurs):
            return text
        say = self.understanding.language.prose.say
        if fails:
            return text.replaced(say["fails"].format(rest.strip()))
        return text.replaced(say["event"].format(head.strip(), rest.strip()))

    def _may_be_case(self, text: ScriptText) -> bool:
        """Return True if a return may be one in a case that nobody knows: `Heavy rain: go home`."""
        head, colon, _ = text.content.partition(":")
        found = mentions_in(text, self.understanding)
        named = any(m.start < len(head) for m in found.mentions if not _is_any(m))
        unknown = any(word.start < len(head) for word in found.unknown)
        rest = [m for m in found.mentions if m.start >= len(head)]
        returns = found.has(*RETURNING) and all(m.kind != "checkpoints" for m in rest)
        return bool(colon) and unknown and not named and returns

    def is_failure(self, text: ScriptText) -> bool:
        """Return True for a failure of any reading: `gauge unreadable`, `Reading fails`."""
        words = self.understanding.words(text)
        if len(words) != 2 or words[0].type not in _OF_ANY:
            return False
        generic = words[0].type != "KIND" or words[0].value[0] in (Kind.CHECKPOINT, Kind.GAUGE)
        return generic and (words[1].type == "FAILS" or words[1].value == "unreadable")

    def _passes_over(self, text: ScriptText) -> bool:
        """Return True for `gauge unreadable: skip it`, which leaves out no more than that one."""
        head, colon, _ = text.content.partition(":")
        if not (colon and self.is_failure(text[: len(head)])):
            return False
        found = mentions_in(text[len(head) + 1 :].strip(), self.understanding)
        points = [m for m in found.of("checkpoints") if not _is_any(m)]
        passing = found.has("leave_out", "NEXT_STEP") and found.only(*_OF_PASSING)
        return passing and not (points or found.unknown)

    def _alike(self, text: ScriptText) -> ScriptText:
        """Return a condition that ends in `likewise` with the orders of the one before it."""
        cues = self.understanding.language.prose.cues
        likewise = re.compile(
            rf"[,:]?\s*{phrase_pattern(cues['likewise']).pattern}\W*$", re.IGNORECASE
        )
        found = likewise.search(text.content)
        _, comma, orders = self.before.partition(",")
        if found is None or not comma:
            return text
        return text.replace(found.start(), len(text.content), f", {orders.strip(' .')}")

    def _composed(self, text: ScriptText, found: Mentions) -> Proposal | None:
        if not found.mentions or self._depends(text, found) or self._removes(text, found):
            return None
        if self._numbers_robot(text, found) or _BACK_TO_ITEM.search(text.content):
            return None
        if any(self._lacks_name(text, mention) for mention in found.of("checkpoints")):
            return None
        self.known.warnings.clear()
        sentences = sentences_of(found, self.known)
        if sentences is None:
            return None
        if not sentences:
            return Proposal(aside="a repetition of what is said above")
        unused = tuple(text.content[word.start : word.end] for word in found.unknown)
        bidden = found.has(*_BIDDING) or "courtesy" not in found.joining
        towards = _TOWARDS if found.has("place") else frozenset()
        plain = bidden and found.joining <= {*_PLAIN, *towards, "courtesy"}
        whole = plain and not unused and not found.has(*_UNSURE)
        whole = whole and not (found.has("MEASURE") and found.only("MEASURE", "place"))
        certain = whole and all(map(_LIKE_CHECKS.match, sentences))
        differences = tuple(dict.fromkeys(self.known.warnings))
        ignored = found.idle if certain else ()
        return Proposal(
            sentences, unused, differences=differences, ignored=ignored, certain=certain
        )

    def _of_clauses(self, text: ScriptText, found: Mentions) -> Proposal | None:
        """Return what the clauses of a text propose, if each of them proposes something or names
        nothing of the mission."""
        cues = self.understanding.language.prose.cues
        cuts = [m.span() for m in phrase_pattern(cues["clause"]).finditer(text.content)]
        cuts += [m.span() for m in _COMMA.finditer(text.content)]
        inside = [m for m in found.of("checkpoints") if isinstance(m.value, Nouns)]
        cuts = [(a, b) for a, b in cuts if not any(m.start < a < m.end for m in inside)]
        starts = [0, *sorted({a for a, _ in cuts} | {b for _, b in cuts}), len(text.content)]
        if not 2 < len(starts) <= _MOST_CLAUSES:
            return None
        before = self.known.state()
        sentences: list[str] = []
        unused: list[str] = []
        i = 0
        while i < len(starts) - 1:
            for k in range(len(starts) - 1, i, -1):
                part = text[starts[i] : starts[k]].strip()
                found = mentions_in(part, self.understanding)
                if evidence(part, found, self.understanding.language, clause=True):
                    unused.append(part.content)
                    break
                made = self._composed(part, found)
                if made is not None:
                    sentences += made.sentences
                    unused += made.unused
                    break
                if not found.mentions and k == i + 1 and not self._depends(part, found):
                    unused += [part.content] if part.content.strip(" ,.;") else []
                    break
            else:
                self.known.reset(before)
                return None
            i = k
        named = _NUMBERED.findall(" ".join(sentences))
        if (unused and any(map(_HOMEWARDS.match, sentences))) or len({*named}) < len(named):
            return None  # `Siren: back to the dock`, `all gauges, but level gauge 1 last`
        return Proposal(tuple(sentences), tuple(unused)) if sentences else None

    def within(self, text: ScriptText) -> ScriptText:
        """Return a text with `too high` as a limit of the checkpoint that is named before it."""
        prose = self.understanding.language.prose
        for name in ("too_high", "too_low"):
            found = phrase_pattern(prose.cues[name]).search(text.content)
            before = mentions_in(text[: found.start()], self.understanding) if found else None
            named = before.of("checkpoints")[-1:] if before is not None else ()
            with suppress(RefusedError):
                checkpoints = self.known.checkpoints(named)
                if found is None or len(checkpoints) != 1:
                    continue
                limit = normal_end(checkpoints[0], name)
                text = text.replace(*found.span(), prose.say[name].format(limit))
        return text

    def _may_be_no_list(self, text: ScriptText, named: Sequence[Mention]) -> bool:
        """Return True for `gauge four is #9`, `PG 1 to PG 4`, `PG 1 - PG 4`, `all valves R12`."""
        for a, b in pairwise(named):
            whole = any(isinstance(noun, AllOf) for noun in a.nouns)
            if whole and not text.content[a.end : b.start].strip():
                return True
        between = {self.understanding.types(text[a.end : b.start]) for a, b in pairwise(named)}
        return bool(between & _NO_LISTS) or (len(named) == 2 and between == {("DASH",)})

    def _lacks_name(self, text: ScriptText, mention: Mention) -> bool:
        """Return True for `level gauge XX`, whose name is still to be written."""
        name = _NO_NAME.match(text.content, mention.end)
        return name is not None and any(isinstance(noun, TheOne) for noun in mention.nouns)

    def _removes(self, text: ScriptText, found: Mentions) -> bool:
        """Return True for `take checkpoint 4 out again`, which nothing else tells from a check."""
        away = phrase_pattern(self.understanding.language.prose.form["away"])
        said = (text.content[word.start : word.end] for word in found.unknown)
        return not found.has("leave_out", "SPARE", "DELETE") and any(map(away.fullmatch, said))

    def _numbers_robot(self, text: ScriptText, found: Mentions) -> bool:
        """Return True for `robot #2`, where the number is that of the robot."""
        subjects = self.understanding.language.lexicon.phrases["SUBJECT", None]
        numbered = (m for m in found.of("checkpoints") if is_number(m))
        before = (text.content[: mention.start].lower().rstrip() for mention in numbered)
        return any(part.endswith(tuple(subjects)) for part in before)

    def _depends(self, text: ScriptText, found: Mentions) -> bool:
        """Return True if a text may begin with a case that it depends on: `On smoke, go home`."""
        cases = self.understanding.language.prose.cues["in_case"]
        begins = phrase_pattern(cases).match(text.content)
        head, comma, _ = text.content.partition(",")
        supposed = phrase_pattern(self.understanding.language.prose.form["supposing"])
        if comma and supposed.match(head) and any(w.start < len(head) for w in found.unknown):
            return True  # `Should floor 6 be blocked, leave out R9`
        if begins is None or not found.unknown or found.occasion:
            return False
        return all(mention.start > found.unknown[0].start for mention in found.mentions)


def _is_any(mention: Mention) -> bool:
    """Return True for `checkpoint` or `gauge` alone, which may be any."""
    return bool(mention.nouns) and all(isinstance(noun, TheOne) for noun in mention.nouns)
