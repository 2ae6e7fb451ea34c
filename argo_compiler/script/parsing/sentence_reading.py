"""Reads the sentences of a script one after the other: which say what, and which have no effect."""

import re
from dataclasses import dataclass, field, replace

from argo_compiler.script.documents.source import Diagnostics, ScriptText, shortened
from argo_compiler.script.layout.asides import Asides, ask_of_remark
from argo_compiler.script.layout.fields import ScriptFields
from argo_compiler.script.layout.items import LineItem
from argo_compiler.script.layout.lines import LineMark
from argo_compiler.script.sentences.doubts import ask_of_words, is_question, placed_in
from argo_compiler.script.sentences.grammar.parser import StumbleError
from argo_compiler.script.sentences.scopes import ask_of_scopes
from argo_compiler.script.sentences.tree.orders import Amend, Follow, Sentence, Start
from argo_compiler.script.sentences.tree.script import Said, Text, Unread
from argo_compiler.script.sentences.understanding import Reading, Understanding
from argo_compiler.script.sentences.words.loading import pattern
from argo_compiler.script.sentences.words.word import VERBS

_POINTING = r"\b<pointing>\b"
"""words for what is listed below, or was measured before"""

_BETWEEN_COMMAS = re.compile(r"(?:^|(?<=,))[^,]*")
MAX_SENTENCE = 10_000
"""characters in a sentence of many lines; a longer one is refused unread"""

_SPARING = frozenset(["EXCEPT", "SPARE", "DELETE"])
"""words of these types in a remark may leave something out"""


@dataclass(frozen=True)
class _Title:
    """A title, and what stands behind it in the same line."""

    head: ScriptText
    fields: ScriptText | None = None
    parts: tuple[ScriptText, ...] = ()
    """what makes sense behind a comma"""


_BIDDING = frozenset([*VERBS, "BE_MEASURED", "IF", "UNLESS"])
"""types of words; a sentence with a question mark and none of them asks for nothing"""


@dataclass
class SentenceReader:
    """Reads sentences. Mutable: what one is depends on those before it."""

    understanding: Understanding
    asides: Asides
    fields: ScriptFields
    diagnostics: Diagnostics
    ordered: bool = False
    """whether anything is to be done by now but to start"""
    begun: bool = False
    """whether anything but a title has been read"""
    listed: str = ""
    """`Pressure gauges`, if that is what was read last"""
    days: dict[str, int] = field(default_factory=dict)
    """the days that sentences were of so far, each with its line"""
    noted: tuple[ScriptText, str] | None = None
    """the text last taken to be without effect, and what it is taken for"""

    def note(self, text: ScriptText, what: str) -> None:
        """Says that a text has no effect."""
        message = f"`{shortened(text.original)}` is taken for {what} and has no effect"
        self.diagnostics.warning("no-effect", message, text.span())
        self.noted = text, what

    def remark(self, text: ScriptText) -> list[Said]:
        """Says that a remark has no effect; a warning, where it tells what is to be done. What it
        says of the order is kept: `Note: valve R40 has to be checked before valve R12.`"""
        inner = self.asides.remark(text)
        if self.asides.ranks(inner):
            return self._ask_of_rank(inner)
        types = {*self.understanding.types(inner)}
        if types & {"BEFORE", "AFTER"} and not types & {"IF", "UNLESS", *VERBS}:
            reading = self.understanding.read(inner)
            if not isinstance(reading, StumbleError):
                return [self._node(inner, reading)]
        if self.asides.overturns(inner) or not _SPARING.isdisjoint(types):
            ask_of_remark(text, self.diagnostics)
        elif self.asides.bids(inner):
            message = f"`{text.content}` is taken for a remark: the command in it has no effect"
            hint = "write it as a step if the robot has to do it"
            self.diagnostics.warning("remark", message, text.span(), hint)
        else:
            message = f"`{shortened(text.content)}` is a remark and has no effect"
            self.diagnostics.note("comment", message, text.span())
        self.noted = text, "a remark"
        return []

    def read(self, text: ScriptText, item: LineItem) -> list[Said]:
        """What a sentence says; nothing where it has no effect."""
        if len(text.content) > MAX_SENTENCE:
            length = len(text.content)
            message = f"the sentence has {length} characters; at most {MAX_SENTENCE} are read"
            return self._unread("too-long", message, text, "write several sentences")
        text = self.understanding.figures(self.understanding.rewritten(text))
        if not self.understanding.types(text):
            if text.content.endswith(":") and self.asides.sets_aside(text):
                self._ask_of_heading(text)  # `Could:`
            else:
                self.note(text, "a remark")
            return []
        if self._is_stray(text, item):
            return self._ask_of_stray(text)
        if item.line.number is None and self.asides.ranks(text):
            return self._ask_of_rank(text)
        self.listed = _kind_listed(text, tuple(self.understanding.types(text)))
        stands_over = item.line.heading or text.content.endswith(":")
        if stands_over and self.fields.introduces(text):
            return []
        if (item.items or stands_over) and self._points_below(text):
            return []
        if {*self.understanding.types(text)} == {"KIND"}:
            if self.asides.sets_aside(text):
                self._ask_of_heading(text)  # `Valves only`
                return []
            if item.line.heading:
                self.note(text, "a heading")  # `Pressure gauges` over steps
                return []
        if text.content.endswith(":") and self.understanding.types(text) == ("VALUE",):
            self.note(text, "a field that a person fills in")
            return []
        whole = text.content == item.text.content.rstrip(".! ") and text.content[-1] != ":"
        alone = whole and item.line.mark is LineMark.NONE and not item.items
        alone = alone and self.understanding.types(text)[:1] == ("MOST_TIME",)
        if (not self.ordered or alone) and self.fields.whole_mission(text):
            return []
        text = self._behind_limit(text)
        reading = self.understanding.read(text)
        if isinstance(reading, StumbleError) or "WORD" in self.understanding.types(text):
            respelled = self.understanding.respelled(text)
            if respelled is not None:
                text, reading = respelled, self.understanding.read(respelled)
                if stands_over and self.fields.introduces(text):
                    return []
        if isinstance(reading, StumbleError):
            cut = self.asides.without(text, first=not self.begun)
            if cut is not None:
                text, asides = cut
                for aside in asides:
                    if self.asides.corrects(aside) and not self.asides.is_reason(aside):
                        ask_of_remark(aside, self.diagnostics)
                    else:
                        self.note(aside, "a remark")
                reading = self.understanding.read(text)
        if isinstance(reading, StumbleError):
            return self._not_understood(text, item, reading)
        if is_question(text, self.understanding.language.lexicon):
            message = "this is a question: it is not clear whether the robot has to do it"
            return self._unread("question", message, text, "write it as an order, or remove it")
        joint = self.understanding.unfinished(text)
        if joint is not None:
            message = f"nothing follows `{joint.content}`"
            hint = "write what follows, or remove it"
            self.diagnostics.error("unfinished", message, joint.span(), hint)
        if text.is_question and {*self.understanding.types(text)}.isdisjoint(_BIDDING):
            hint = "write it as a command if it is meant, or remove it"
            return self._unread("not-understood", "this is a question", text, hint)
        node = self._node(text, reading)
        introduces = text.content.endswith(":") and not item.items
        if introduces and item.over and not _is_amend(node):
            return self._announced(text, node)
        if stands_over and not item.items and _is_amend(node):
            message = "this is above other lines, and only says how they are done"
            hint = "write it in each of them, or write them as sub-steps of this line"
            return self._unread("stray-clause", message, text, hint)
        return [node]

    def _behind_limit(self, text: ScriptText) -> ScriptText:
        """Read what a sentence says of the mission as a whole before `then`, and return the rest:
        `20 min max, then back to its dock`."""
        words = self.understanding.words(text)
        joint = next((i for i, word in enumerate(words) if word.type == "NEXT"), 0)
        if not joint or words[joint - 1].type != "MOST_TIME" or joint + 1 == len(words):
            return text
        head, rest = text[: words[joint - 1].end], text[words[joint + 1].start :]
        if not self.fields.says_whole(head) or not self.understanding.fits(rest):
            return text
        self.fields.whole_mission(head)
        return rest

    def read_decided(self, text: ScriptText) -> list[Said]:
        """Read a sentence that a person has decided on: it has no title, and no slips."""
        if self.fields.whole_mission(text):
            return []
        reading = self.understanding.read(text)
        if isinstance(reading, StumbleError):
            self.understanding.not_understood(text, reading)
            return [Unread(span=text.span())]
        return [self._node(text, reading)]

    def _announced(self, text: ScriptText, node: Said) -> list[Said]:
        """What a line over steps of their own says besides `do the following:`."""
        if not isinstance(node, Sentence) or node.cases or not node.orders:
            return [node]
        *orders, last = node.orders
        if not isinstance(last, Follow) or last.manner or last.name is not None:
            return [node]
        self.diagnostics.warning(
            "no-effect", f"`{text.content}` has no effect by itself", text.span()
        )
        return [replace(node, orders=tuple(orders))] if orders or node.facts else []

    def _ask_of_rank(self, text: ScriptText) -> list[Said]:
        message = f"`{text.content}` can mean all of them, or the order of the other lines"
        hint = "write `check all ...` as a step, or the steps in the intended order"
        return self._unread("ambiguous-order", message, text, hint)

    def _ask_of_stray(self, text: ScriptText) -> list[Said]:
        number, listed = text.content, self.listed
        message, hint = (
            f"`{number}` can be checkpoint {number}",
            f"write `check checkpoint {number}`",
        )
        if listed:
            message += f", one more of the `{listed}` above it"
            hint += f", or `{listed}:` above the list"
        message, hint = f"{message}, or have no meaning", f"{hint}, or remove it"
        return self._unread("not-understood", message, text, hint)

    def _unread(self, code: str, message: str, text: ScriptText, hint: str) -> list[Said]:
        """Says what is wrong with a sentence, of which is not known then what it asks for."""
        self.diagnostics.error(code, message, text.span(), hint)
        return [Unread(span=text.span())]

    def _points_below(self, text: ScriptText) -> bool:
        """Return True for a sentence that may mean what is listed below it: `Please check these:`
        is noted as a heading, and one that says more is asked about."""
        types = {*self.understanding.types(text)}
        if not types & {"THEM", "THIS"} or not pattern(_POINTING).search(text.content):
            return False
        if types <= {"MEASURE", "BE_MEASURED", "THEM", "THIS", "COLON", "GO"}:
            self.note(text, "a heading")
            return True
        message = "this can be about what is listed below, or about what was measured before"
        hint = "name the checkpoints, or write `do the following:`"
        self.diagnostics.error("ambiguous-pronoun", message, text.span(), hint)
        return True

    def _is_stray(self, text: ScriptText, item: LineItem) -> bool:
        """Return True for a number alone, as a page's or behind `ext.`, if no list says of what."""
        alone = item.line.mark is LineMark.NONE and text.content == item.text.content
        behind = text.first > item.text.first
        number = self.understanding.types(text) == ("NUMBER",)
        return number and (alone or behind) and not self.fields.lists

    def _node(self, text: ScriptText, reading: Reading) -> Said:
        self.begun = True
        lexicon = self.understanding.language.lexicon
        ask_of_words(text, lexicon, self.diagnostics, self.ordered, self.days)
        node = self.understanding.node(text, reading)
        if isinstance(node, Sentence):
            placed = placed_in(text, node, lexicon)
            node = replace(node, placed=placed) if placed else node
            ask_of_scopes(node, self.understanding.joints("or"), self.diagnostics)
            self.ordered |= any(not isinstance(order, Start) for order in node.orders)
        return Unread(span=text.span()) if node is None else node

    def _not_understood(
        self, text: ScriptText, item: LineItem, stumble: StumbleError
    ) -> list[Said]:
        """What makes no sense: said of the mission as a whole, a title, small talk or an error."""
        if self.fields.whole_mission(text):
            return []
        free = item.line.mark in (LineMark.NONE, LineMark.BULLET) and item.line.number is None
        if free and self.fields.leaves_open(text):
            return []
        if free and self.asides.is_small_talk(text):
            self.note(text, "a remark")
            return []
        header = self.fields.header
        first = not self.begun and header.title is None and item.line.number is None
        title = self._title(text, item, first)
        if title is not None:
            return self._entitled(title, item, first)
        if not self.fields.is_unknown(text):
            self.understanding.not_understood(text, stumble)
        self.begun = True
        return [Unread(span=text.span())]

    # ---- titles and headings, with what stands behind them: `Evening round, at most 40 minutes`

    def _title(self, text: ScriptText, item: LineItem, first: bool) -> _Title | None:
        """The title that a text may be. `first`: nothing but it has been read, and it is no
        step."""
        if not first and not self._is_heading(text, item):
            return None
        titled = self.fields.behind(text) if first else None
        if titled is not None and self.asides.is_title(titled[0]):
            return _Title(titled[0], fields=titled[1])
        alone = text.content == item.text.content
        over = first and alone and item.line.heading and self.asides.stands_for_title(text)
        named = not first and self.asides.names_tasks(text)
        if over or (self.asides.is_title(text) and not named):
            return _Title(text)
        if not first or "," not in text.content:
            return None
        head = text[: text.content.index(",")]
        if self.asides.names_tasks(head) or self.asides.names(head):
            return None
        types = self.understanding.types(head)
        if "NUMBER" in types and "TIME_WORD" not in types:
            return None  # `Ma 6, R18` may name two checkpoints
        parts = self._behind(text[len(head.content) + 1 :].strip())
        return _Title(head, parts=parts) if self.asides.is_title(head) and parts else None

    def _behind(self, text: ScriptText) -> tuple[ScriptText, ...]:
        """The parts of what stands behind a title, if all of them make sense."""
        parts = tuple(
            text[m.start() : m.end()].strip() for m in _BETWEEN_COMMAS.finditer(text.content)
        )
        says_whole, fits = self.fields.says_whole, self.understanding.fits
        sensible = (
            p for p in (parts, (text,)) if all(says_whole(part) or fits(part) for part in p)
        )
        return next(sensible, ())

    def _is_heading(self, text: ScriptText, item: LineItem) -> bool:
        """Whether a line stands over others: marked as a heading, or with items of its own."""
        line = item.line
        if self.fields.has_value(text):
            return False
        whole = text.content == item.text.content.rstrip(".!")
        above = bool(item.items) or text.content.endswith(":")
        return line.heading or (whole and line.number is None and above)

    def _entitled(self, title: _Title, item: LineItem, first: bool) -> list[Said]:
        """Keeps a title, and reads what stands behind it."""
        self.begun = True
        content = title.head.content
        listing = not first or content.endswith(":") or bool(item.items) or " " not in content
        excludes = self.asides.sets_aside(title.head) or self.asides.turns(title.head)
        if excludes or (listing and self.asides.keeps_away(title.head)):
            self._ask_of_heading(title.head)
        elif first:
            doubtful = not self.asides.is_title(title.head) or self.asides.names_tasks(title.head)
            self._entitle(title.head, asked=doubtful)
        else:
            self.note(title.head, "a heading")
        if title.fields is not None:
            rest = self.fields.read_all(title.fields)
            return self.read(rest, item) if rest.content else []
        said: list[Said] = []
        for part in title.parts:
            reading = self.understanding.read(part)
            if not self.fields.whole_mission(part) and not isinstance(reading, StumbleError):
                said.append(self._node(part, reading))
        return said

    def _ask_of_heading(self, heading: ScriptText) -> None:
        message = (
            f"`{heading.content}` can mean that the lines below it are not tasks, or not always"
        )
        hint = "remove the lines that are not tasks, and the heading; or write another heading"
        self.diagnostics.error("ambiguous-title", message, heading.span(), hint)

    def _entitle(self, title: ScriptText, asked: bool = False) -> None:
        """Takes a text for the title; with a warning, where something may be asked for in it."""
        header = self.fields.header
        header.title = Text(span=title.span(), text=title.content)
        self.noted = title, "the title"
        header.format_title = self.asides.is_explicit_title(title)
        if asked:
            message = f"`{title.content}` is taken for the title, and adds no task"
            hint = "write it as a step if the robot has to do it"
            self.diagnostics.warning("title", message, title.span(), hint)
        elif not self.asides.is_explicit_title(title):
            message = f"`{title.content}` is taken for the title, and has no effect on what is done"
            self.diagnostics.note("title", message, title.span())


def _is_amend(node: Said) -> bool:
    """Whether a sentence says only how something is done."""
    if not isinstance(node, Sentence) or node.cases or not node.orders:
        return False
    return all(isinstance(order, Amend) for order in node.orders)


def _kind_listed(text: ScriptText, types: tuple[str, ...]) -> str:
    """The words for the kind where a text is a checkpoint's kind, or that with its number."""
    listed = types[:1] == ("KIND",) and {*types[1:]} <= {"NUMBER", "HASH", "IDENT"}
    return text.content.rstrip("0123456789#: ") if listed else ""
