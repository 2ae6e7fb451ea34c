"""The fields of a header: `Maximum duration: 20'`, `Start: area 2`, and the cells of a sheet.

A value is understood as a whole or refused: no word of it is passed over. Sentences may say of the
mission as a whole what fields say as well: `In any order, please.`
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any, NamedTuple

from argo_compiler.base.listing import listed
from argo_compiler.il import Mode, Order
from argo_compiler.script.documents.source import Diagnostics, ScriptText
from argo_compiler.script.sentences.building.part import RulePart, seconds
from argo_compiler.script.sentences.tree import orders
from argo_compiler.script.sentences.tree.orders import Sentence
from argo_compiler.script.sentences.tree.places import Coordinates, Steps
from argo_compiler.script.sentences.tree.script import AreaChosen, Areas, ScriptHeader, Text
from argo_compiler.script.sentences.understanding import Understanding
from argo_compiler.script.sentences.words.lexer import unquoted
from argo_compiler.script.sentences.words.lexicon import expand
from argo_compiler.script.sentences.words.loading import pattern
from argo_compiler.script.sentences.words.prose import phrase_pattern
from argo_compiler.script.sentences.words.spelling import candidates, nearest
from argo_compiler.script.sentences.words.word import VERBS, Word

_ANY_LABEL = re.compile(r"[^\W\d_][\w'/-]*\.?(?:\s+[\w'/-]+){0,6}\s*:(?=\s|$)")
_REPORTS = frozenset(["anomaly_specification", "real_time_reporting", "after_mission_report"])
_CELLS = _REPORTS | {"initial_position", "end_of_mission"}
_CHECKPOINTS = frozenset(
    [("HASH", "NUMBER"), ("KIND", "NUMBER"), ("KIND", "IDENT"), ("KIND", "HASH")]
)
"""types of words, side by side, that name a checkpoint"""
_RANGES = frozenset(["QUANTITY", "GREATER", "LESS", "BETWEEN", "AT_LEAST", "AT_MOST", "UPTO"])
"""types of words of a range of values"""
_PROSE_FIELDS = _REPORTS | {"designation", "site"}
_SAME = {"start_area": "initial_position", "end_area": "end_of_mission"}
"""fields that say the same"""
_STOP = re.compile(r"[.!](?=\s|$)")
_SEPARATORS = " ,;/|"
"""between fields"""
_INITIAL = re.compile(r"\b(?:[A-Z]|Dr|Mr|Mrs|Ms)\.")
"""in a name: `J. Smith`"""
_QUOTED = re.compile(r'"(?:[^"\\]|\\.)*"(?:[\s,]*"(?:[^"\\]|\\.)*")*')
_TOKEN = re.compile(r"[\w'-]+")
_BRIDGES = ("AND_", "OR_", "JOINT")
_WHOLE = re.compile(r"(?:(?:ANY_ORDER|THIS_ORDER|(?:MOST_TIME|WITHIN DURATION)(?: TOTAL)?) )+")
_JOINTS = frozenset(["NEXT", "JOINT", "AND_NOUN", "AND_AMOUNT", "AND_TEST", "AND_NUMBER"])
_INTRODUCTION = re.compile(
    r"(?:WORD )?(?:TO )?(?:MEASURE )?(?:ALL |THEM |DO_FOLLOWING )?KIND (?:ANY|THIS)_ORDER "
)


class Field(NamedTuple):
    """A label with its value, and what stands behind them in the line."""

    name: str
    label: ScriptText
    value: ScriptText
    rest: ScriptText


@dataclass
class ScriptFields:
    """Finds the fields of a text, and keeps what they say in the header. Mutable: it grows field by
    field."""

    understanding: Understanding
    diagnostics: Diagnostics
    header: ScriptHeader = field(default_factory=ScriptHeader)
    count: int = 0
    """how many fields were read, or sentences that say what fields say"""
    lists: bool = False
    """whether `Checkpoints:` stands above"""
    first: list[Sentence] = field(default_factory=list)
    last: list[Sentence] = field(default_factory=list)
    """what is to be done at the very end: `Finish: at the front of the site`"""
    _said: dict[str, tuple[Any, ScriptText]] = field(default_factory=dict)
    """what the fields say, and where"""

    def __post_init__(self) -> None:
        self.prose = self.understanding.language.prose

    # ---- labels

    def is_field(self, text: ScriptText) -> bool:
        """Whether a line begins with a field's label."""
        return self.prose.label.match(text.content) is not None

    def is_cell(self, text: ScriptText) -> bool:
        """Whether a line begins with the label of a field that may have several lines."""
        label = self.prose.label.match(text.content)
        return label is not None and label.lastgroup in _CELLS

    def relabelled(self, text: ScriptText) -> ScriptText:
        """The text with a misspelt label put right."""
        label = _ANY_LABEL.match(text.content)
        if label is None or ":" not in text.content or self.is_field(text):
            return text
        fixed, found = text, []
        for word in reversed(list(re.finditer(r"[\w'-]+", label[0]))):
            if word[0].lower() in self.prose.label_words:
                continue
            if pattern("<driving>").fullmatch(word[0]) is not None:
                return text
            meant = candidates(word[0], self.prose.label_words)
            if len(meant) != 1:
                return text
            fixed = fixed.replace(word.start(), word.end(), meant[0])
            found.append((word[0], meant[0], text.span(word.start(), word.end())))
        if not found or not self.is_field(fixed):
            return text
        for said, meant_word, span in found:
            self.diagnostics.warning("respelled", f"read `{said}` as `{meant_word}`", span)
        return fixed

    def has_value(self, text: ScriptText) -> bool:
        """Whether a line has the shape of a field."""
        label = _ANY_LABEL.match(text.content)
        return label is not None and bool(text.content[label.end() :].strip())

    def is_unknown(self, text: ScriptText) -> bool:
        """Whether a line that makes no sense has a label that there is not; then it is said."""
        label = _ANY_LABEL.match(text.content)
        if label is None or not self.has_value(text):
            return False
        said = text[: label.end() - 1].strip()
        if {"IF", *VERBS} & {*self.understanding.types(said)}:
            return False
        close = nearest(said.content, self.prose.shown_labels, 1)
        hint = f"the fields are {listed(f'`{k}:`' for k in self.prose.shown_labels)}"
        hint = f"is `{close[0]}:` meant? {hint}" if close else hint
        self.diagnostics.error(
            "unknown-label", f"there is no field `{said.content}`", said.span(), hint
        )
        return True

    # ---- lines

    def next(self, text: ScriptText) -> Field | None:
        """Return the field that a line begins with; a line may have several: `Start: area 2, end:
        area 1.`, or sentences behind it."""
        label = self.prose.label.match(text.content)
        if label is None:
            return None
        name = label.lastgroup
        assert name is not None
        value = text[label.end() :].strip()
        if name == "steps":
            return Field(name, text[: label.end()], value[:0], value)
        end = self._end(name, value.content)
        rest = value[end:].strip()
        ends = _SEPARATORS if name in _PROSE_FIELDS else f"{_SEPARATORS}."
        said = value[: len(value.content[:end].rstrip(ends))]
        rest = rest[len(rest.content) - len(rest.content.lstrip(f"{_SEPARATORS}.")) :]
        return Field(name, text[: label.end()], said, rest)

    def read(self, field: Field) -> None:
        """Take what a field says into the header."""
        if field.name == "steps":
            self.lists = True
        else:
            self._value(field.name, field.value, field.label)

    def read_all(self, text: ScriptText) -> ScriptText:
        """Read the fields that a line begins with, and return the rest of the line."""
        while (field := self.next(text)) is not None:
            self.read(field)
            text = field.rest
            if field.name == "steps":
                break
        return text

    def behind(self, text: ScriptText) -> tuple[ScriptText, ScriptText] | None:
        """A title and the fields behind it: `Work order 12 / start: area 1`."""
        for label in self.prose.label.finditer(text.content):
            title = text.content[: label.start()].rstrip()
            if title and title[-1] in _SEPARATORS:
                return text[: len(title.rstrip(_SEPARATORS))], text[label.start() :]
        return None

    def _end(self, name: str, content: str) -> int:
        """Where the value of a field ends: at the next label or, unless it is prose, sentence;
        what stands in quotation marks is no part of either."""
        if quoted := _QUOTED.match(content):
            return quoted.end()
        ends = [
            m.start()
            for m in self.prose.label.finditer(content)
            if content[: m.start()].rstrip()[-1:] in (*_SEPARATORS.strip(), ".")
        ]
        if name == "nothing":
            content = _INITIAL.sub(lambda found: "x" * len(found[0]), content)
        if name not in _PROSE_FIELDS and (stop := _STOP.search(content)):
            ends.append(stop.end())
        return min((e for e in ends if e > 0), default=len(content))

    # ---- values

    def _set(self, name: str, meaning: Any, value: ScriptText, key: Any = None) -> None:
        """Keeps a field, unless it stands elsewhere with another value; None: it has an error.
        The key is what tells two values apart, where the meaning has its place in it."""
        if meaning is not None and self._is_new(name, meaning if key is None else key, value):
            setattr(self.header, name, meaning)

    def _is_new(self, name: str, key: Any, value: ScriptText) -> bool:
        """Whether a field is said for the first time; another value than before is an error."""
        self.count += 1
        known, before = self._said.setdefault(name, (key, value))
        if known == key:
            return before is value
        line = before.span().line
        message = f"line {line} has `{before.content}`, but this line has `{value.content}`"
        hint = "remove one of the two"
        self.diagnostics.error("repeated-field", message, value.span(), hint)
        return False

    def _value(self, name: str, value: ScriptText, label: ScriptText) -> None:
        """Reads a field by its name."""
        if not value.content:
            if name in _PROSE_FIELDS:
                return
            message, hint = "this field has no value", "write its value, or remove the line"
            self.diagnostics.error("field", message, label.span(), hint)
            return
        value = self.understanding.figures(value) if name not in _PROSE_FIELDS else value
        match name:
            case "nothing":
                self._nothing(value, label)
            case "mode":
                self._set(name, self._meaning(name, value, Mode), value)
            case "order":
                self._set(name, self._meaning(name, value, Order), value)
            case "max_duration":
                self._duration(value)
            case "initial_position" | "end_of_mission":
                self._place(name, value)
            case "start_area" | "end_area":
                chosen = self._chosen(value)
                same = _SAME[name]
                key = (chosen.area,) if chosen and chosen.area is not None else ()
                if chosen is not None and self._is_new(same, key, value):
                    setattr(self.header, name, chosen)
            case "dock":
                self._dock(value)
            case "current":
                self._current(value)
            case "left_out":
                self._left_out(value)
            case "anomaly_specification" if self._names_checkpoint(value):
                message = "this gives a checkpoint other normal values than the site has"
                hint = "write a condition, such as `if #1 is below 2 or above 3, ...`; or set the "
                hint += "line aside, to use the values of the site"
                self.diagnostics.error("field", message, value.span(), hint)
            case _:
                text = self._text(value)
                self._set(name, text, value, text and text.text)

    def _names_checkpoint(self, value: ScriptText) -> bool:
        """Return True if a text has other normal values for a checkpoint: `#1: 2 to 3 bar`."""
        if value.content.startswith('"'):
            return False  # as it was written by `format_script`
        types = self.understanding.types(value)
        return bool({*pairwise(types)} & _CHECKPOINTS) and not _RANGES.isdisjoint(types)

    def _text(self, value: ScriptText) -> Text | None:
        said = " ".join(value.content.split())
        quoted = re.fullmatch(r'"(?:[^"\\]|\\.)*"(?:\s*"(?:[^"\\]|\\.)*")*', value.content)
        text = unquoted(value.content) if quoted else said
        if text is None:
            message = "this quoted text has an escape that does not exist"
            hint = r"write a backslash as `\\` and a quotation mark as `\"`"
            self.diagnostics.error("quoted-text", message, value.span(), hint)
            return None
        return Text(span=value.span(), text=text)

    def _nothing(self, value: ScriptText, label: ScriptText) -> None:
        words = self.understanding.words(value)
        types = [word.type for word in words]
        names = (value.content[w.start : w.end].lower() for w in words if w.type == "IDENT")
        named = {*types} & {"KIND", "HASH", "DOCK"} or ("AREA", "NUMBER") in pairwise(types)
        if named or {*types[:1]} & {*VERBS} or any(n in self.understanding.names for n in names):
            message = f"a field `{label.content.rstrip(' :')}` has no effect on a mission"
            hint = "write a sentence if the robot has to do something, or remove the line"
            self.diagnostics.error("unknown-label", message, label.span(), hint)
            return
        said = label.source.text[label.offsets[0] : value.offsets[-1] + 1]
        self.diagnostics.warning("no-effect", f"`{said}` has no effect", label.span())

    def _meaning(self, name: str, value: ScriptText, kind: type[Mode] | type[Order]) -> Any:
        """What one of a few values means."""
        found = self.prose.meanings.get((name, _plain(value)))
        if found is None:
            known = {m: said for (n, said), m in reversed(self.prose.meanings.items()) if n == name}
            choices = listed((f"`{known[meaning]}`" for meaning in kind), "or")
            message = f"`{value.content}` is not a valid {name}"
            self.diagnostics.error("field", message, value.span(), f"write {choices}")
        return found

    def _is_none(self, value: ScriptText) -> bool:
        return ("none", _plain(value)) in self.prose.meanings

    def _duration(self, value: ScriptText) -> None:
        """Reads the maximum duration."""
        if self._is_none(value):
            self._is_new("max_duration", "none", value)
            return
        found = self.understanding.words(value)
        lengths = [w for w in found if w.type in ("DURATION", "MOST_TIME")]
        others = [w for w in found if w not in lengths and w.type != "TOTAL"]
        if len(lengths) != 1 or others:
            at = value[others[0].start : others[0].end] if lengths and others else value
            message = f"`{value.content}` is not a duration"
            hint = "write, for example, `20 min`, `1 h 30 min` or `none`"
            self.diagnostics.error("duration", message, at.span(), hint)
            return
        (word,) = lengths
        errors = self.diagnostics.errors
        part = RulePart((word,), value, word.start, word.end, self.diagnostics)
        length = seconds(part, word)
        if self.diagnostics.errors == errors:
            node = Text(span=value.span(), text=value.content)
            self._set("max_duration", (length, node), value, length)

    def _place(self, name: str, value: ScriptText) -> None:
        """`docked in starting area 1 or 2`, or any other place."""
        if name == "end_of_mission" and self._is_none(value):
            chosen = AreaChosen(span=value.span(), area=None, as_planned=False)
            if self._is_new(name, (), value):
                self.header.end_area = chosen
            return
        found = self.understanding.words(value)
        areas_named = next(self._numbers_of_areas(found), None) is not None
        where = None if areas_named else self.understanding.location(value)
        dock_named = any(word.type == "DOCK" for word in found)
        if where is None or isinstance(where, tuple) or dock_named:
            areas = self._areas(value, dock_named)
            self._set(name, areas, value, areas and areas.areas)
            return
        if not self._is_new(name, _plain(value), value):
            return
        span = value.span()
        if name == "initial_position":
            order: orders.ScriptOrder = orders.Start(span=span, where=where)
            self.first.append(Sentence(span=span, orders=(order,), cases=()))
        else:
            order = orders.Go(span=span, where=where)
            self.last.append(Sentence(span=span, orders=(order,), cases=()))

    def _dock(self, value: ScriptText) -> None:
        where = None if self._is_none(value) else self.understanding.location(value)
        if where is not None and not isinstance(where, Coordinates):
            message, hint = "this field has the coordinates of a dock", "write `(3, -2.5, 0)`"
            self.diagnostics.error("field", message, value.span(), hint)
        elif where is None and not self._is_none(value):
            self._no_value(value, "write `(3, -2.5, 0) heading 90 degrees`, or `none`")
        else:
            self.header.dock_said, self.header.dock = True, where

    def _current(self, value: ScriptText) -> None:
        found = [w for w in self.understanding.words(value) if w.type != "STEP"]
        point: int | str | None = None
        if len(found) == 1 and found[0].type == "STRING":
            point = found[0].value
        elif len(found) == 1 and found[0].type == "NUMBER":
            point = found[0].value.whole
        if point is None:
            self._no_value(value, 'write a step or a name: `3`, `"MEASURE 4"`')
        else:
            self._set("current", Steps(span=value.span(), points=(point,)), value, point)

    def _left_out(self, value: ScriptText) -> None:
        found = [w for w in self.understanding.words(value) if not w.type.startswith("AND_")]
        names = tuple(str(w.value) for w in found if w.type == "STRING")
        if len(names) != len([w for w in found if w.type != "JOINT"]) or not names:
            self._no_value(value, 'write names in quotation marks: `"MEASURE 4", "MEASURE 8"`')
        else:
            self._set("left_out", names, value)

    def _no_value(self, value: ScriptText, hint: str) -> None:
        message = f"Argo does not understand `{value.content}` here"
        self.diagnostics.error("field", message, value.span(), hint)

    # ---- starting areas: `docked in "Starting area" 1 or 2, chosen by the staff`

    def _areas(self, value: ScriptText, dock: bool) -> Areas | None:
        """The areas that a field offers; more than one leaves the choice open."""
        errors = self.diagnostics.errors
        found = list(self._numbers_of_areas(self.understanding.words(value)))
        covered = [span for _, span in found]
        areas: list[int] = []
        for word, _ in found:
            number = word.value.whole
            if number is None or number > 9999:
                said = value[word.start : word.end]
                message = f"`{said.content}` is not the number of a starting area"
                hint = "write, for example, `area 1`"
                self.diagnostics.error("number", message, said.span(), hint)
            else:
                areas.append(number)
        last = max((end for _, end in covered), default=0)
        tail = value.content.find(",", last)
        if tail > 0 and not self._may_ask(value[tail + 1 :].strip()):
            aside = value[tail + 1 :].strip()
            if aside.content:
                message = f"`{aside.content}` has no effect"
                self.diagnostics.warning("no-effect", message, aside.span())
        else:
            tail = len(value.content)
        self._refuse_strays(value, tail, covered)
        if self.diagnostics.errors > errors:
            return None
        at = value[found[0][0].start : found[0][0].end] if found else value
        return Areas(span=at.span(), areas=tuple(areas), dock=dock)

    def _may_ask(self, aside: ScriptText) -> bool:
        """Whether words behind an area may change what it means."""
        types = {*self.understanding.types(aside)}
        return bool(types & {"NOT", "IF", "IF_ONLY", "UNLESS", "EXCEPT", "AREA", "NUMBER", "ELSE"})

    def _refuse_strays(self, value: ScriptText, end: int, covered: list[tuple[int, int]]) -> None:
        around = frozenset(expand(self.prose.around_areas))
        for token in _TOKEN.finditer(value.content, 0, end):
            said = token[0].lower()
            if any(a <= token.start() < b for a, b in covered):
                continue
            joins = said in self.understanding.joints("or")
            if said not in around and not (joins and any(a > token.start() for a, _ in covered)):
                span = value.span(token.start(), token.end())
                message = f"Argo does not understand `{token[0]}` here"
                hint = "write, for example, `docked in starting area 1`, or `starting area 1 or 2`"
                self.diagnostics.error("not-understood", message, span, hint)
                return

    def _numbers_of_areas(self, found: list[Word]) -> Iterator[tuple[Word, tuple[int, int]]]:
        """The numbers of areas, with what of the text each covers."""
        inside = False
        start = 0
        only_numbers = all(w.type == "NUMBER" or w.type.startswith(_BRIDGES) for w in found)
        for i, word in enumerate(found):
            if word.type == "AREA":
                inside, start = True, word.start
            elif word.type == "NUMBER" and (inside or only_numbers):
                yield word, (start if inside else word.start, word.end)
                inside, start = True, word.end
            elif not word.type.startswith(_BRIDGES) or i + 1 == len(found):
                inside = False

    def _chosen(self, value: ScriptText) -> AreaChosen | None:
        """`1`, `none`, `1, as planned`."""
        said, comma, behind = value.content.partition(",")
        planned = ("as_planned", behind.strip().lower()) in self.prose.meanings
        number = re.fullmatch(
            r"(?:(?:(?:starting )?area|startbereich)\s+)?([0-9]{1,4})", said.strip().lower()
        )
        none = ("none", said.strip().lower()) in self.prose.meanings
        if (number is None and not none) or bool(comma) != planned:
            message = f"Argo does not understand `{value.content}` here"
            hint = "write the area's number, or `none`, and `, as planned` after it if needed"
            self.diagnostics.error("field", message, value.span(), hint)
            return None
        area = int(number[1]) if number is not None else None
        return AreaChosen(span=value.span(), area=area, as_planned=planned)

    # ---- sentences that say what fields say

    def introduces(self, text: ScriptText) -> bool:
        """Reads the sentence over the steps: `Control the checkpoints in this precise order:`."""
        types = self.understanding.types(text)
        if not _INTRODUCTION.fullmatch("".join(f"{type_} " for type_ in types)):
            return False
        order = Order.ANY if types[-1] == "ANY_ORDER" else Order.PRECISE
        self._set("order", order, text)
        for word in self.understanding.named_kinds(text):
            said = text[word.start : word.end]
            message = f"`{said.content}` has no effect: the lines below name what is checked"
            self.diagnostics.warning("no-effect", message, said.span())
        return True

    def leaves_open(self, text: ScriptText) -> bool:
        """Reads a sentence that leaves the docks open: `The docks are chosen on the day`."""
        said = phrase_pattern(self.prose.left_open).match(text.content)
        if said is None or self._may_ask(text[said.end() :]):
            return False
        self.header.areas_open = Text(span=text.span(), text=text.content)
        return True

    def says_whole(self, text: ScriptText) -> bool:
        """Whether a text is about the mission as a whole, if nothing is ordered before it."""
        types = [t for t in self.understanding.types(text) if t not in _JOINTS]
        return _WHOLE.fullmatch("".join(f"{type_} " for type_ in types)) is not None

    def whole_mission(self, text: ScriptText) -> bool:
        """Reads what is said of the mission as a whole by itself: `In any order, at most 40 min`.
        False: that is not what it says."""
        if not self.says_whole(text):
            return False
        for word in self.understanding.words(text):
            if word.type in ("ANY_ORDER", "THIS_ORDER"):
                order = Order.ANY if word.type == "ANY_ORDER" else Order.PRECISE
                self._set("order", order, text[word.start : word.end])
            elif word.type in ("DURATION", "MOST_TIME"):
                self._duration(text[word.start : word.end])
        return True


def _plain(value: ScriptText) -> str:
    return " ".join(value.content.lower().strip(" .!").split())
