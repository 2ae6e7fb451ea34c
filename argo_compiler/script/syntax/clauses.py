"""The clauses of a protocol's step: what the grammar's trees of them mean, one by one."""

import re
from dataclasses import dataclass
from math import radians
from typing import Any, ClassVar, NamedTuple

from argo_compiler.diagnostics import Span
from argo_compiler.il import MAX_COUNT, MAX_RETRIES, ConditionType, EventKind, Mode, Order
from argo_compiler.script.syntax.building import Builder, Figure, Numbered, Phrase, Quoted, Time
from argo_compiler.script.syntax.commands import Joints, Normality, Side
from argo_compiler.script.syntax.nodes import (
    AreaHeader,
    CurrentHeader,
    DockHeader,
    DurationHeader,
    Hint,
    LeftOutHeader,
    ModeField,
    OrderField,
    TextField,
)
from argo_compiler.script.syntax.quantities import ORDINALS
from argo_compiler.script.syntax.spelling import respell
from argo_compiler.script.syntax.terms import (
    AreaLocation,
    Coordinates,
    DockLocation,
    FloorName,
    Location,
    Name,
    NamedFloor,
    Number,
    PlaceLocation,
    Quantity,
    Reference,
    StepRef,
)

_EVENTS = {kind.value: kind for kind in EventKind}
_SPEED_UNITS = {"km": 1 / 3.6}
_WORD = re.compile(r"[\w-]+")


class Clause(NamedTuple):
    """A piece of a sentence: what kind of piece, what it says, and where in its statement."""

    kind: str
    value: Any
    start: int
    end: int


@dataclass(frozen=True, slots=True)
class HeaderClause:
    """A header line: the name of the protocol's field, and the node for it."""

    field: str
    node: Any


@dataclass(frozen=True, slots=True)
class Statement:
    """A step before its clauses are put together."""

    number: int | None
    clauses: tuple[Clause, ...]


@dataclass(frozen=True, slots=True)
class ValueTest:
    """A comparison without what is compared."""

    test: ConditionType | Normality
    param1: float = 0.0
    param2: float | None = None
    inclusive: bool = False
    units: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Detail:
    """What stands in brackets behind a condition's checkpoint."""

    id: str | None = None
    second_bound: float | None = None


@dataclass(frozen=True, slots=True)
class Count:
    """`three times`, `three more times`."""

    rounds: int
    more: bool = False


@dataclass(frozen=True, slots=True)
class _Unit:
    text: str


@dataclass(frozen=True, slots=True)
class _RangeEnd:
    number: int


class Flag(str):
    """A word whose kind is all that it says."""

    __slots__ = ()


def _flag(kind: str) -> Any:
    def build(_: Builder, phrase: Phrase) -> Clause:
        return Clause(kind, None, phrase.start, phrase.end)

    return build


class LineBuilder(Builder):
    """Builds the lines of a protocol."""

    constants: ClassVar[dict[str, Any]] = {
        **Builder.constants,
        "after": Side.AFTER,
        "before": Side.BEFORE,
        "top": NamedFloor.TOP,
        "bottom": NamedFloor.BOTTOM,
        "minus": Flag("minus"),
        "more": Flag("more"),
        "radians": Flag("radians"),
        "none": Flag("none"),
        "as_planned": Flag("as planned"),
        "everything": Flag("all"),
        "normal": Normality.NORMAL,
        "abnormal": Normality.ABNORMAL,
        "greater": Flag("greater"),
        "less": Flag("less"),
        "at_least": Flag("at least"),
        "at_most": Flag("at most"),
        "from_to": Flag("from"),
        "impossible": Flag("impossible"),
        "once": 1,
        "twice": 2,
        "again": Count(1, more=True),
        **_EVENTS,
        "some_obstacle": Flag("obstacle"),
    }

    passed = frozenset(["signed"])

    comma, semicolon, full_stop = _flag("comma"), _flag("semicolon"), _flag("full stop")
    conjunction, disjunction, sequence = _flag("and"), _flag("or"), _flag("then")
    after_that = _flag("afterwards")
    if_, if_not, unless = _flag("if"), _flag("otherwise"), _flag("unless")
    otherwise, fails, adverb = _flag("otherwise"), _flag("fails"), _flag("adverb")
    go_on, end_mission, abort, done = _flag("go on"), _flag("end"), _flag("abort"), _flag("done")
    report, pause, resume = _flag("report"), _flag("pause"), _flag("resume")
    recharge, home, in_circles = _flag("recharge"), _flag("home"), _flag("nothing")
    soft, hard, endless = _flag("soft"), _flag("hard"), _flag("endless")
    included, excluded = _flag("included"), _flag("excluded")
    meet = _flag("meet")
    it = _flag("it")

    hint_label = designation_label = site_label = anomaly_label = Builder.label_end
    real_time_label = after_mission_label = Builder.label_end
    initial_position_label = end_of_mission_label = Builder.label_end

    # ---- lines

    def title(self, phrase: Phrase) -> HeaderClause:
        text = " ".join(phrase.content.split())
        return HeaderClause("title", TextField(span=phrase.span, text=text))

    def hint(self, phrase: Phrase) -> Hint:
        return Hint(span=phrase.span, text=self.field_text(phrase).content)

    def _text(self, field: str, phrase: Phrase) -> HeaderClause:
        text = self.field_text(phrase)
        span = text.span() if text.content else phrase.span
        return HeaderClause(field, TextField(span=span, text=self.free_text(text)))

    def designation(self, phrase: Phrase) -> HeaderClause:
        return self._text("designation", phrase)

    def site(self, phrase: Phrase) -> HeaderClause:
        return self._text("site", phrase)

    def anomaly(self, phrase: Phrase) -> HeaderClause:
        return self._text("anomaly_specification", phrase)

    def real_time(self, phrase: Phrase) -> HeaderClause:
        return self._text("real_time_reporting", phrase)

    def after_mission(self, phrase: Phrase) -> HeaderClause:
        return self._text("after_mission_report", phrase)

    def initial_position(self, phrase: Phrase) -> HeaderClause:
        return HeaderClause("initial_position", self.field_text(phrase))

    def end_of_mission(self, phrase: Phrase) -> HeaderClause:
        return HeaderClause("end_of_mission", self.field_text(phrase))

    def mode(self, phrase: Phrase) -> HeaderClause:
        return HeaderClause("mode", ModeField(span=phrase.span, mode=phrase.the(Mode)))

    def order(self, phrase: Phrase) -> HeaderClause:
        return HeaderClause("order", OrderField(span=phrase.span, order=phrase.the(Order)))

    def max_duration(self, phrase: Phrase) -> HeaderClause:
        times = phrase.every(Time)
        seconds = self.duration(times).seconds if times else None
        return HeaderClause("max_duration", DurationHeader(span=phrase.span, seconds=seconds))

    def _area(self, field: str, phrase: Phrase) -> HeaderClause:
        number = next((c for c in phrase.children if isinstance(c, (int, float))), None)
        if number is not None and number != int(number):
            message = f"there is no area {number}"
            self.diagnostics.error("number", message, phrase.span, "write a whole number")
        area = None if number is None else int(number)
        as_planned = any(c == "as planned" for c in phrase.every(Flag))
        return HeaderClause(field, AreaHeader(span=phrase.span, area=area, as_planned=as_planned))

    def start_area(self, phrase: Phrase) -> HeaderClause:
        return self._area("start_area", phrase)

    def end_area(self, phrase: Phrase) -> HeaderClause:
        return self._area("end_area", phrase)

    start_area_none, end_area_none = start_area, end_area

    def dock_line(self, phrase: Phrase) -> HeaderClause:
        found = phrase.first(Coordinates)
        for clause in phrase.every(Clause):
            assert found is not None
            found = self.placed(found, clause)
        return HeaderClause("dock", DockHeader(span=phrase.span, dock=found))

    def current(self, phrase: Phrase) -> HeaderClause:
        ref = phrase.first(Clause)
        task = ref.value if ref else StepRef(span=phrase.span, first=self._points(phrase)[0])
        return HeaderClause("current", CurrentHeader(span=phrase.span, task=task))

    def left_out(self, phrase: Phrase) -> HeaderClause:
        names = tuple(quoted.text for quoted in phrase.every(Quoted))
        return HeaderClause("left_out", LeftOutHeader(span=phrase.span, tasks=names))

    def step(self, phrase: Phrase) -> Statement:
        clauses = tuple([child for child in phrase.children if type(child) is Clause])
        return Statement(phrase.first(int), clauses)

    # ---- parts

    def string(self, phrase: Phrase) -> Quoted:
        return Quoted(self.unquote(phrase))

    string_item = string

    def signed(self, phrase: Phrase) -> float | int:
        value: float | int = phrase.children[-1]
        return -value

    def ordinal(self, phrase: Phrase) -> Figure:
        return self.number(phrase)

    def range_end(self, phrase: Phrase) -> _RangeEnd:
        return _RangeEnd(phrase.the(Figure).value)

    def count(self, phrase: Phrase) -> int:
        return int(phrase.content)

    def quantity_unit(self, phrase: Phrase) -> _Unit:
        return _Unit("".join(phrase.content.split()))

    def speed_unit(self, phrase: Phrase) -> _Unit:
        return _Unit(phrase.content)

    def reference(self, phrase: Phrase) -> Reference | None:
        """The checkpoint that a phrase names, if it names one."""
        number = name = quantity = last = None
        for child in phrase.children:
            if type(child) is Numbered:
                number = child.number
            elif type(child) is Name:
                name = child
            elif type(child) is Quantity:
                quantity = child
            elif type(child) is _RangeEnd:
                last = child.number
        if number is None and name is None:
            return None
        return Reference(span=phrase.span, number=number, name=name, quantity=quantity, last=last)

    def subject(self, phrase: Phrase) -> Clause:
        reference = self.reference(phrase)
        if reference is not None:
            kind = "bracket" if phrase.statement.content[phrase.start] == "(" else "subject"
            return Clause(kind, reference, phrase.start, phrase.end)
        if details := phrase.every(Detail):
            ids = [d.id for d in details if d.id is not None]
            bounds = [d.second_bound for d in details if d.second_bound is not None]
            detail = Detail(ids[0] if ids else None, bounds[0] if bounds else None)
            return Clause("detail", detail, phrase.start, phrase.end)
        return Clause("it", None, phrase.start, phrase.end)

    def called(self, phrase: Phrase) -> Detail:
        return Detail(id=phrase.the(Quoted).text)

    def second_bound(self, phrase: Phrase) -> Detail:
        return Detail(second_bound=float(phrase.children[0]))

    def both(self, phrase: Phrase) -> Clause:
        clause = phrase.the(Clause)
        return Clause("bracket", clause.value, phrase.start, phrase.end)

    def bare(self, phrase: Phrase) -> Clause:
        number = Number(span=phrase.span, value=self._whole(phrase) or 0)
        return Clause("bare", number, phrase.start, phrase.end)

    def _points(self, phrase: Phrase) -> list[int | str]:
        points: list[int | str] = []
        for child in phrase.children:
            if isinstance(child, Quoted):
                points.append(child.text)
            elif isinstance(child, Flag | Clause):
                continue
            elif isinstance(child, int):
                points.append(child)
        return points

    def point(self, phrase: Phrase) -> int:
        value = float(phrase.content)
        if not value.is_integer():
            message = f"there is no step {phrase.content}"
            self.diagnostics.error("number", message, phrase.span, "write a whole number")
            return 0
        return int(value)

    def step_ref(self, phrase: Phrase) -> Clause:
        first, *last = self._points(phrase)
        ref = StepRef(span=phrase.span, first=first, last=last[0] if last else None)
        return Clause("step", ref, phrase.start, phrase.end)

    # ---- places

    def floor(self, phrase: Phrase) -> Clause:
        edge, number = phrase.first(NamedFloor), phrase.first(Figure)
        value: int | NamedFloor = edge if edge is not None else number.value if number else 0
        node = FloorName(span=number.phrase.span if number else phrase.span, number=value)
        return Clause("floor", node, phrase.start, phrase.end)

    floors = floor

    def on_floor(self, phrase: Phrase) -> Clause:
        return Clause("on floor", phrase.the(Clause).value, phrase.start, phrase.end)

    def area(self, phrase: Phrase) -> Clause:
        node = AreaLocation(span=phrase.span, area=phrase.the(Figure).node)
        return Clause("place", node, phrase.start, phrase.end)

    def dock(self, phrase: Phrase) -> Clause:
        area = phrase.first(Clause)
        node = DockLocation(span=phrase.span, area=area.value.area if area else None)
        return Clause("place", node, phrase.start, phrase.end)

    def place(self, phrase: Phrase) -> Clause:
        quoted = phrase.first(Quoted)
        name = quoted.text if quoted else " ".join(phrase.content.split())
        return Clause("place", PlaceLocation(span=phrase.span, name=name), phrase.start, phrase.end)

    def coordinates(self, phrase: Phrase) -> Coordinates:
        x, y, *z = (float(child) for child in phrase.children)
        return Coordinates(span=phrase.span, x=x, y=y, z=z[0] if z else None)

    def bare_coordinates(self, phrase: Phrase) -> Clause:
        return Clause("place", phrase.children[0], phrase.start, phrase.end)

    def location(self, phrase: Phrase) -> Clause:
        clause = self._place(phrase)
        return Clause("place", clause, phrase.start, phrase.end)

    def _place(self, phrase: Phrase) -> Any:
        found = phrase.children[-1]
        return found.value if isinstance(found, Clause) else found

    def height(self, phrase: Phrase) -> Clause:
        return Clause("height", float(phrase.children[0]), phrase.start, phrase.end)

    def heading(self, phrase: Phrase) -> Clause:
        value = float(phrase.children[0])
        yaw = value if phrase.first(Flag) else radians(value)
        return Clause("heading", yaw, phrase.start, phrase.end)

    @staticmethod
    def placed(point: Coordinates, clause: Clause) -> Coordinates:
        """The point with its height, floor or heading set."""
        x, y, z, floor, yaw = point.x, point.y, point.z, point.floor, point.yaw
        if clause.kind == "height":
            z = clause.value
        elif clause.kind == "heading":
            yaw = clause.value
        else:
            floor = clause.value
        return Coordinates(span=point.span, x=x, y=y, z=z, floor=floor, yaw=yaw)

    # ---- commands

    def task_name(self, phrase: Phrase) -> Clause:
        name = phrase.the(Quoted).text
        if not name and "\\" not in phrase.content:  # a wrong escape has its own error
            hint = "write a name between the quotation marks, or leave them out"
            self.diagnostics.error("empty-name", "this name is empty", phrase.span, hint)
        return Clause("name", name, phrase.start, phrase.end)

    def set_start(self, phrase: Phrase) -> Clause:
        return Clause("set start", self._place(phrase), phrase.start, phrase.end)

    def start_here(self, phrase: Phrase) -> Clause:
        return Clause("start here", phrase.first(Coordinates), phrase.start, phrase.end)

    def patrol(self, phrase: Phrase) -> Clause:
        place: Location | FloorName = self._place(phrase)
        if isinstance(place, PlaceLocation):
            place = self._misspelt_floor(place) or place
        return Clause("patrol", place, phrase.start, phrase.end)

    def _misspelt_floor(self, place: PlaceLocation) -> FloorName | None:
        """`the secnd floor`, which could have been a place's name."""
        said, _, floor = place.name.lower().removeprefix("the ").rpartition(" ")
        word = respell(said, ORDINALS) if floor == "floor" else None
        if word is None:
            return None
        at = place.name.lower().index(said)
        span = Span(line=place.span.line, column=place.span.column + at, length=len(said))
        self.diagnostics.warning("respelled", f"read `{said}` as `{word}`", span)
        return FloorName(span=place.span, number=ORDINALS.index(word) + 1)

    def go(self, phrase: Phrase) -> Clause:
        return Clause("go", self._place(phrase), phrase.start, phrase.end)

    def measure(self, phrase: Phrase) -> Clause:
        return Clause("measure", phrase.the(Clause), phrase.start, phrase.end)

    def add(self, phrase: Phrase) -> Clause:
        return Clause("add", phrase.the(Clause), phrase.start, phrase.end)

    def delete(self, phrase: Phrase) -> Clause:
        return Clause("delete", phrase.the(Clause), phrase.start, phrase.end)

    def move(self, phrase: Phrase) -> Clause:
        return Clause("move", phrase.the(Clause), phrase.start, phrase.end)

    def replace(self, phrase: Phrase) -> Clause:
        return Clause("replace", phrase.the(Clause), phrase.start, phrase.end)

    def side(self, phrase: Phrase) -> Clause:
        value = phrase.the(Side), phrase.the(Clause)
        return Clause("side", value, phrase.start, phrase.end)

    def by(self, phrase: Phrase) -> Clause:
        return Clause("by", phrase.the(Clause), phrase.start, phrase.end)

    def jump(self, phrase: Phrase) -> Clause:
        return Clause("jump", phrase.the(Clause).value, phrase.start, phrase.end)

    def repeat(self, phrase: Phrase) -> Clause:
        ref = phrase.first(Clause)
        return Clause("repeat", ref.value if ref else None, phrase.start, phrase.end)

    # ---- conditions

    def comparison(self, phrase: Phrase) -> Clause:
        words = phrase.every(Flag)
        values = [float(c) for c in phrase.children if isinstance(c, (int, float))]
        units = tuple([unit.text for unit in phrase.every(_Unit)])
        word = words[0] if words else None
        normality = phrase.first(Normality)
        bounds = None
        if normality is not None:
            bounds = ValueTest(normality)
        elif word in ("greater", "at least"):
            bounds = ValueTest(
                ConditionType.GREATER, values[0], inclusive=word == "at least", units=units
            )
        elif word in ("less", "at most"):
            bounds = ValueTest(
                ConditionType.LESS, values[0], inclusive=word == "at most", units=units
            )
        elif len(values) == 2:
            low, high = values
            bounds = ValueTest(ConditionType.WITHIN, low, high, word == "from", units)
        else:
            hint = (
                "a mission can only ask for less, for greater, or for between two values: "
                "write `is from 4.9 to 5.1`, or turn the condition and `otherwise` round"
            )
            message = f"a mission has no condition such as `{phrase.content}`"
            self.diagnostics.error("condition", message, phrase.span, hint)
        return Clause("comparison", bounds, phrase.start, phrase.end)

    def measured_within(self, phrase: Phrase) -> Clause:
        seconds = self.duration(phrase.every(Time)).seconds
        return Clause("age", seconds, phrase.start, phrase.end)

    def retry(self, phrase: Phrase) -> Clause:
        tries = self._whole(phrase, MAX_RETRIES)
        return Clause("retry", 1 if tries is None else tries, phrase.start, phrase.end)

    def _whole(self, phrase: Phrase, most: int = MAX_COUNT) -> int | None:
        for child in phrase.children:
            if isinstance(child, int | float) and not isinstance(child, bool):
                if child != int(child):
                    message = f"`{phrase.content}` is not a whole number"
                    self.diagnostics.error("number", message, phrase.span, "write a whole number")
                elif abs(child) > most:
                    message = f"`{phrase.content}`: this is too large a number"
                    hint = f"numbers go up to {most} here"
                    self.diagnostics.error("number", message, phrase.span, hint)
                return int(child)
        return None

    # ---- reactions

    def event(self, phrase: Phrase) -> Clause:
        kind = phrase.first(EventKind)
        if kind is None:
            message = "an obstacle may be positive or negative: in the way, or a part missing of it"
            hint = "write `a positive obstacle` or `a negative obstacle`"
            self.diagnostics.error("ambiguous-event", message, phrase.span, hint)
        return Clause("event", kind, phrase.start, phrase.end)

    def occasion(self, phrase: Phrase) -> Clause:
        return Clause("occasion", phrase.the(Clause).value, phrase.start, phrase.end)

    def until(self, phrase: Phrase) -> Clause:
        return Clause("until", phrase.the(Clause).value, phrase.start, phrase.end)

    def wait(self, phrase: Phrase) -> Clause:
        event = phrase.first(Clause)
        kind = "wait until" if event else "wait"
        return Clause(kind, event.value if event else None, phrase.start, phrase.end)

    def priority(self, phrase: Phrase) -> Clause:
        value = self._whole(phrase)
        return Clause("priority", value, phrase.start, phrase.end)

    def at_pose(self, phrase: Phrase) -> Clause:
        return Clause("at", phrase.the(Coordinates), phrase.start, phrase.end)

    # ---- manner and limits

    def _speed(self, phrase: Phrase) -> float:
        value = float(phrase.first(int) or phrase.first(float) or 0)
        if value <= 0:
            message = "a speed of zero"
            self.diagnostics.error("speed", message, phrase.span, "write, say, `at 0.3 m/s`")
        return value / 3.6 if phrase.the(_Unit).text.lower().startswith("k") else value

    def speed(self, phrase: Phrase) -> Clause:
        return Clause("speed", self._speed(phrase), phrase.start, phrase.end)

    def leaving(self, phrase: Phrase) -> Clause:
        return Clause("leaving", self._speed(phrase), phrase.start, phrase.end)

    def standing(self, phrase: Phrase) -> Clause:
        return Clause("standing", phrase.the(Coordinates), phrase.start, phrase.end)

    def shown(self, phrase: Phrase) -> Clause:
        return Clause("shown", phrase.the(Quoted).text, phrase.start, phrase.end)

    def about(self, phrase: Phrase) -> Clause:
        return Clause("about", phrase.the(Quoted).text, phrase.start, phrase.end)

    def joints(self, phrase: Phrase) -> Clause:
        names = tuple(quoted.text for quoted in phrase.every(Quoted))
        positions = tuple(float(c) for c in phrase.children if isinstance(c, int | float))
        return Clause("joints", Joints(names=names, positions=positions), phrase.start, phrase.end)

    def rounds(self, phrase: Phrase) -> Clause:
        count = phrase.first(Count)
        if count is None:
            more = phrase.first(Flag) is not None
            count = Count(self._whole(phrase, MAX_COUNT - more) or 0, more)
        if count.rounds == 0:
            hint = "write how often, say, `three times`"
            self.diagnostics.error("rounds", "a patrol of no rounds", phrase.span, hint)
        return Clause("rounds", count, phrase.start, phrase.end)

    def for_(self, phrase: Phrase) -> Clause:
        times = phrase.every(Time)
        rounds = phrase.first(Clause)
        if not times:
            assert rounds is not None
            return rounds
        value = self.duration(times).seconds, rounds.value if rounds else None
        return Clause("for", value, phrase.start, phrase.end)
