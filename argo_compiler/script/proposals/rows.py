"""What a row of a sheet asks for: that the checkpoint which it names is read.

Each cell is compared with what the site knows of the checkpoint. A row whose cells all agree with
it is understood; one with words that say more is proposed; ticks, dashes and `N/A` are asked about.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from itertools import pairwise

from argo_compiler.base.catalog import CheckpointInfo, CheckpointKind
from argo_compiler.script.documents.signs import CLOCK, place_in_order
from argo_compiler.script.documents.source import RefusedError, ScriptText, join
from argo_compiler.script.documents.tags import count_tag, tag_of
from argo_compiler.script.layout.forms import SHEET_HEADINGS, Cell, CellRole, FormRow
from argo_compiler.script.proposals.composing import RETURNING, Composer, Proposal
from argo_compiler.script.proposals.evidence import is_name, missing_reading
from argo_compiler.script.proposals.frames import Sentences, has_no_floor, placed
from argo_compiler.script.proposals.known import Known, is_number
from argo_compiler.script.proposals.mentions import (
    OF_FORMS,
    Mention,
    Mentions,
    checkpoint_words,
    mentions_in,
)
from argo_compiler.script.proposals.paraphrasing import ORDERS, reads, rephrased, sentence
from argo_compiler.script.sentences.tree.nouns import AllOf, Nouns, TheOne
from argo_compiler.script.sentences.tree.places import FloorName
from argo_compiler.script.sentences.understanding import COMPARING
from argo_compiler.script.sentences.words.lexer import all_words, says_order
from argo_compiler.script.sentences.words.lexicon import expand
from argo_compiler.script.sentences.words.loading import pattern
from argo_compiler.script.sentences.words.numbers import Figure
from argo_compiler.script.sentences.words.prose import phrase_pattern
from argo_compiler.script.sentences.words.without_effect import TOLD

_FILL = re.compile(r"_{2,}|\.{3,}|…+|[□☐]|\[\s*\]|\(\s*y\s*/\s*n\s*\)|/", re.IGNORECASE)
_UNIT_BEHIND = re.compile(
    r"^\s*[^\W\d_].*?(?:_{2,}|\.{4,})\s*([^\W\d_]\S{0,5}|[%°]\w?)\s*(?:[<>(\[].*)?$"
)
"""a blank to fill in with a unit behind it: `Conductivity ______ uS`"""
_OF_UNITS = frozenset(["UNIT", "QUANTITY", "NUMBER", "DASH", "TO", "SIGN"])
"""types of words in a cell with no more than a unit or a range"""
_TICK = re.compile(r"[xX✓✔☑☒]")
_HASH = re.compile(r"#\d+")
"""a checkpoint by its number, or by its tag, which was replaced by that"""
_LABELLED = re.compile(r"[^:]{1,40}:\s*([^:]*)")
_RANGE = re.compile(
    r"(?P<low>\d+(?:[.,]\d+)?)\s*(?:-|–|—|to|bis|\.\.)\s*(?P<high>\d+(?:[.,]\d+)?)\s*(?P<unit>[^\d\s]\S*)?"
)
_PLAIN_RANGE = re.compile(r"[\d.,]+\s*(?:-|–|—|to|bis|\.\.)\s*[\d.,]+")
_NUMBERED = re.compile(r"(?:(?:no|nr)\.?\s*|#\s*)?\d{1,6}", re.IGNORECASE)
_NUMBER = re.compile(r"\d+(?:\.\d+)*\.?")
_BARE = re.compile(r"\d+(?:[.,]\d+)?(?: ?[^\d\s]\S*)?|[A-Za-z]")
"""a number, perhaps with a unit, or a letter"""
_PLAIN = re.compile(r"\d+(?:[.,]\d+)?")
_BAR = {"bar": 1.0, "kpa": 0.01, "mbar": 0.001, "psi": 0.0689476, "mpa": 10.0}
_UNITS = {
    CheckpointKind.PRESSURE_GAUGE: frozenset([*_BAR, "barg", "bar g"]),
    CheckpointKind.LIQUID_LEVEL_GAUGE: frozenset(["%", "percent", "prozent"]),
    CheckpointKind.VALVE: frozenset(["deg", "°", "degrees", "grad", "-", "–"]),
}
_ALL_UNITS = frozenset().union(*_UNITS.values())
_POSITIONS = ("half", "open", "closed")
_OPEN, _CLOSED = 70.0, 20.0
"""degrees from which a valve's normal position counts as open, and up to which as closed"""
_FEW_WORDS = 2
_ORDER_WORDS = ("first", "last", "ORDINAL", "AT_BEGIN", "AT_END")
"""kinds of mentions that say in which order rows are done"""
_ALIKE = str.maketrans("il|058", "111osb")
"""signs that text recognition takes for others"""
_IDLE_CELL = re.compile(r"[-–—_. \d,/%]*|[A-Za-z]?\d*[a-z]?[.):]?")
"""nothing, a dash, a blank to fill in, points, or the number of an item: `B2`, `3.`"""
_TICKED_BOX = re.compile(r"[☑☒✓✔✗✘]|\[[xX*✓✔]\]")
_CHECKPOINT = re.compile(r"(?:#|(?:CP|KP|C)[-_ ]?)?0*([1-9][0-9]{0,4})", re.IGNORECASE)
"""in a column of checkpoints"""
_IDLE = OF_FORMS | {
    *("checkpoints", "place", "UNIT", "LSQB", "RSQB", "LPAR_HOW", "everything"),
    *("BOTH", "each", "FLOOR", "AREA", "FLOOR_NAME", "OUTSIDE", "EXACTLY", "leave_out"),
    *("UNIT_S", "Y", "HASH", "OR", "OR_TEST", "HALF", "STRING", "GO", "start"),
}
"""kinds of mentions that do not change how, when or whether the checkpoint of a row is read"""
_BESIDE = OF_FORMS - {"MEASURE", "BE_MEASURED", "measuring"}
"""kinds of mentions that belong to the unknown words beside them: `alarm operator`"""
_ACTING = ("home", "HOME", "ABORT", "WAIT", "PAUSE", "leave_out", "GO_ON", "NEXT_STEP")
"""kinds of mentions that say what is done in a case"""
_TICKED = "this row is ticked, or marked as done: it may be left out"


@dataclass
class _Row:
    """A row while its cells are read."""

    named: list[CheckpointInfo] = field(default_factory=list)
    unused: list[str] = field(default_factory=list)
    doubts: list[str] = field(default_factory=list)
    differences: list[str] = field(default_factory=list)
    left_out: bool = False
    tag: str = ""
    """a plant tag that is not known"""
    manner: str = ""
    described: list[str] = field(default_factory=list)
    """words of the service that a plant tag has: `contactor overhead`"""
    together: bool = False
    """whether a single cell names all of several checkpoints"""
    reaction: ScriptText | None = None
    """what is done if the reading is not normal"""
    sentences: tuple[str, ...] = ()
    """what a cell says of how and when the checkpoint is read"""
    times: int | None = None
    """how often a remark may say that it is read"""
    span: ScriptText | None = None
    """how long after another row it is read"""
    unclear: str = ""
    """a cell with a kind alone, which is not what another row names"""
    window: str = ""
    """what a range may mean if it is one of minutes"""
    ordered: bool = False
    """whether a cell may say in which order it is read"""
    free: bool = False
    """whether it names all of a kind on a floor, whose order is free"""


def propose_row(row: FormRow, composer: Composer, first: bool = False) -> Proposal:
    """Return what a row proposes; `certain` if every cell agrees with the site. `first`: it is the
    first line of the script, and may be its title."""
    if row.is_heading:
        times = [c for c in row.cells if CLOCK.fullmatch(c.text.content)]
        if len(times) > 1:
            doubt = "these times can be rounds at these times of day"
            return Proposal(choices=((),), doubt=f"{doubt}{_filled_below(row)}")
        return Proposal(aside=SHEET_HEADINGS)
    if not row.doubt and _is_idle_field(row, composer):
        return Proposal(aside="a field that a mission does not have")
    of_case = _case(row, composer)
    if of_case is not None:
        return of_case
    found = _Row()
    tagged = any(_HASH.fullmatch(cell.text.content) for cell in row.cells)
    for cell in row.cells:
        if _read_sheet_cell(cell, found, composer):
            continue
        before = len(found.unused)
        _read_cell(cell.text, found, composer)
        if cell.role is CellRole.NAME and tagged:
            found.described += found.unused[before:]
    ids = {c.id: c for c in found.named}
    if not ids:
        doubt = f"it is not clear which `{found.unclear}` is meant"
        unclear = Proposal(choices=((),), doubt=doubt)
        made = unclear if found.unclear else _without_checkpoint(row, composer, first)
        scanned = _scanned(row.place.content, composer.known) if made.is_open else ()
        return replace(made, choices=(*scanned, *made.choices)) if scanned else made
    if found.described and len(ids) == 1:
        found.unused = [word for word in found.unused if word not in found.described]
    _compare(row.cells, next(iter(ids.values())), found, composer)
    found.unused += _unexplained(row, ids)
    found.doubts += _denials(row, composer)
    words = checkpoint_words(list(ids.values()))
    check, spare = f"Check {words}{found.manner}.", f"Do not check {words}."
    if row.doubt:
        return Proposal(choices=((spare,), (check,)), doubt=row.doubt)
    if "~~" in row.place.content:
        return Proposal(choices=((spare,), (check,)), doubt=_TICKED)
    if len(ids) > 1 and "(" in row.place.content:  # `valve R31 (see #11)`
        each = [(f"Check checkpoint {id}.",) for id in ids]
        return Proposal(choices=(*each, (check,), ()), doubt="this row names several checkpoints")
    if (row.box is not None and row.box.strip()) or _TICKED_BOX.search(row.place.content):
        return Proposal(choices=((spare,), (check,)), doubt=_TICKED)
    if found.tag and _may_explain(row, found.tag):
        doubt = f"this can be a task, or only say what `{found.tag}` stands for"
        return Proposal(choices=((check,), ()), doubt=doubt)
    if found.ordered and len(found.doubts) == 1:
        return Proposal(doubt=found.doubts[0])
    if found.doubts:
        single = [(f"Check checkpoint {id}.",) for id in ids] if len(ids) > 1 else []
        manners = [found.window] if found.window else []
        manners += [f" {found.times} times"] if found.times and len(ids) == 1 else []
        timed: list[Sentences] = [(f"Check {words}{manner}.",) for manner in manners]
        if found.span is not None and len(ids) == 1:
            timed = [*_after_row(found.span, next(iter(ids)), composer), *timed]
        return Proposal(choices=(*timed, (spare,), (check,), *single), doubt=found.doubts[0])
    if found.left_out:
        return Proposal((spare,), tuple(found.unused))
    if len(ids) > 1 and found.free:
        composer.known.measured(list(ids.values()))
        return Proposal((f"Check {words} in any order.",), tuple(found.unused))
    if len(ids) > 1 and len(row.cells) > 1 and not (found.together and found.manner):
        return Proposal(choices=((check,), ()), doubt="this row names several checkpoints")
    composer.known.measured(list(ids.values()))
    unused = tuple(found.unused)
    if found.reaction is not None:
        case = composer.understanding.language.prose.say["if_abnormal"]
        said = case.format(next(iter(ids)), found.reaction.content)
        text = rephrased(found.reaction.replaced(said), composer.understanding).text
        inner = Proposal((sentence(text),))
        if len(ids) > 1 or not reads(text, composer.understanding):
            inner = composer.propose(text) if len(ids) == 1 else Proposal()
        if not inner.sentences:
            doubt = f"`{found.reaction.content}` is not understood here"
            return Proposal(choices=((check,), (spare,)), doubt=doubt)
        differences = tuple(found.differences)
        return Proposal((check, *inner.sentences), unused, differences=differences)
    if found.sentences:
        return Proposal(found.sentences, unused, differences=tuple(found.differences))
    return Proposal((check,), unused, differences=tuple(found.differences), certain=not unused)


def _case(row: FormRow, composer: Composer) -> Proposal | None:
    """Return what is done in the case that the first of two cells has: `R7 over 50° | go home`;
    None for another row."""
    if len(row.cells) != 2 or row.box is not None or row.doubt or _FILL.search(row.place.content):
        return None
    case, done = (cell.text for cell in row.cells)
    if composer.is_failure(case):
        return composer.propose(join([case, done], ": "))
    types = COMPARING & {*composer.understanding.types(case)}
    orders = mentions_in(done, composer.understanding).has("checkpoints", *RETURNING)
    form = composer.understanding.language.prose.form
    limited = types != {"STATE"} and _without_fill(done.content, form)
    named = mentions_in(case, composer.understanding).of("checkpoints")
    if not (types and named and (orders or limited)):
        return None
    with suppress(RefusedError):
        if tuple(composer.known.checkpoints(named)) != composer.known.memory.last:
            return Proposal()  # it is not clear when that is done
    text = composer.understanding.rewritten(join([case, done], " -> "))
    whole = reads(text, composer.understanding)
    return Proposal((sentence(text),)) if whole else composer.propose(text)


def naming(row: FormRow) -> ScriptText:
    """Return the text of a row without the numbers below headings, which name no checkpoint."""
    idle = [cell for cell in row.cells if _is_bare_number(cell)]
    return join([c.text for c in row.cells if c not in idle], " | ") if idle else row.place


def _is_bare_number(cell: Cell) -> bool:
    named = cell.role in (CellRole.CHECKPOINT, CellRole.NAME)
    return cell.column is not None and not named and _BARE.fullmatch(cell.text.content) is not None


def _is_unknown_case(row: FormRow, composer: Composer) -> bool:
    """Return True for `Heavy rain | go home`: what is done in a case that nobody knows, and never
    without that case."""
    cells = [cell.text for cell in row.cells if cell.role is not CellRole.NUMBER]
    if len(cells) < 2:
        return False
    case = mentions_in(cells[0], composer.understanding)
    acts = [mentions_in(cell, composer.understanding) for cell in cells[1:]]
    needed = [m for m in case.mentions if m.kind not in (*OF_FORMS, "FLOOR", "place")]
    return bool(case.unknown) and not needed and any(act.has(*_ACTING) for act in acts)


def only_floors(found: Mentions) -> bool:
    """Return True if a text mentions floors, and nothing else."""
    floors = [m for m in found.mentions if m.kind == "place" and isinstance(m.value, tuple)]
    return bool(floors) and len(floors) == len(found.mentions)


def _filled_below(row: FormRow) -> str:
    """Return that readings are filled in below the times of day in a row of headings."""
    if not row.filled_below:
        return ""
    first, last = row.filled_below[0], row.filled_below[-1]
    document = first.source.document
    if document is None:
        return ", and readings are filled in"
    spans = (text.span() for text in (first, last))
    a, b = (document.place_at(span.line, span.column) for span in spans)
    return f", and readings are filled in ({a} to {b})"


def _is_idle_field(row: FormRow, composer: Composer) -> bool:
    """Return True if a row is a label that no mission has, such as `Order no.`, and a value without
    effect; a number alone names no checkpoint there."""
    if not row.labelled or row.box is not None or len(row.cells) != 2:
        return False
    label, value = (cell.text for cell in row.cells)
    labels = composer.understanding.language.prose.form["labels"]
    if phrase_pattern(labels).search(label.content) is None:
        return False
    found = mentions_in(row.place, composer.understanding)
    needed = [m for m in found.mentions if m.kind not in OF_FORMS]
    return not needed or _NUMBERED.fullmatch(value.content) is not None


def _may_explain(row: FormRow, said: str) -> bool:
    """Return True if a row may only explain a tag that the script uses elsewhere."""
    plain = len(row.cells) == 2 and row.box is None and not _FILL.search(row.place.content)
    tag = tag_of(said)
    return plain and tag is not None and count_tag(tag, row.place.source.text) > 1


def _without_checkpoint(row: FormRow, composer: Composer, first: bool) -> Proposal:
    """Return what a row without a checkpoint is: a field to fill in, one that a mission does not
    have, an order such as to dock, or something to ask about."""
    if row.doubt:
        return Proposal(choices=((row.place.content.strip("~ "),), ()), doubt=row.doubt)
    plain = row.box is None or not row.box.strip()
    if row.box is None and first and _is_title(row.place, composer):
        return Proposal(aside="the title")
    tags = [cell.text.content for cell in row.cells if tag_of(cell.text.content)]
    if tags:
        return Proposal(choices=((),), doubt=f"the tag `{tags[0]}` is not known")
    blank = _FILL.search(row.place.content) is not None
    if plain and (unit := _UNIT_BEHIND.search(row.place.content)) and not tags:
        form = composer.understanding.language.prose.form
        if _without_fill(unit[1], form) and "UNIT_S" not in composer.understanding.types(row.place):
            return Proposal(doubt="this asks for a reading of what the site does not have")
    if plain and blank and _has_unit(row, composer):
        return Proposal(doubt="this asks for a reading, and names nothing that the site has")
    if plain and blank and not _needed(row.place, composer):
        return Proposal(aside="a field that a person fills in")
    found = mentions_in(row.place, composer.understanding)
    if plain and not found.unknown and only_floors(found):
        return Proposal(aside="a heading")
    if row.computed:
        return Proposal(aside="a result that the sheet computes")
    if plain and _is_unknown_case(row, composer):
        return Proposal(choices=((),), doubt="Argo does not know this case", complete=True)
    if plain and len(row.cells) == 2 and _needed(row.place, composer):
        # `Robot starts from | starting area 2`, `Gas detected | return to the dock`
        for joint in (" ", ": ") if _needed(row.cells[0].text, composer) else (": ",):
            inner = composer.propose(join([cell.text for cell in row.cells], joint))
            if inner.sentences:
                return inner
    labels = composer.understanding.language.prose.form["labels"]
    first_cell = row.cells[0].text.content if row.cells else ""
    idle = phrase_pattern(labels).search(first_cell) is not None
    named = mentions_in(row.place, composer.understanding).has("checkpoints", "place")
    if plain and ((row.labelled and idle and not named) or _names_people(row)):
        return Proposal(aside="a field that a mission does not have")
    roles = (CellRole.NAME, CellRole.ACTION, CellRole.OTHER)
    said = [cell.text for cell in row.cells if cell.role in roles]
    dropped: tuple[str, ...] = ()
    if len(said) > 1 and ((first and _is_title(said[0], composer)) or _is_label(row, composer)):
        dropped, said = (said[0].content,), said[1:]
    beside = [cell.text for cell in row.cells if cell.role not in roles]
    beside = [text for text in beside if not _IDLE_CELL.fullmatch(text.content)]
    asking = [text for text in beside if _asks(text, composer)]
    if plain and len(said) == 1 and said[0].content and asking:
        doubt = f"`{asking[0].content}` can change what is done here"
        return Proposal(choices=((sentence(said[0]),), ()), doubt=doubt)
    dropped += tuple(text.content for text in beside)
    if plain and len(said) == 1 and said[0].content:
        orders = mentions_in(said[0], composer.understanding).has(*ORDERS)
        if orders and reads(said[0], composer.understanding):
            return Proposal((sentence(said[0]),), dropped, certain=not dropped)
        inner = composer.propose(said[0])
        inner = replace(
            inner, unused=(*dropped, *inner.unused), certain=inner.certain and not dropped
        )
        return inner if inner.sentences or len(row.cells) == 1 else Proposal(choices=((),))
    return Proposal(choices=((),))


def _scanned(content: str, known: Known) -> tuple[Sentences, ...]:
    """Return what a row may be whose words text recognition has cut: `Va lve Rl2`."""
    squeezed = _squeezed(content)
    names = {c.id: _squeezed(c.name) for c in known.catalog.checkpoints}
    found = [id for id, name in names.items() if name in squeezed]
    longest = [a for a in found if not any(names[a] in names[b] for b in found if a != b)]
    return tuple((f"Check checkpoint {id}.",) for id in longest)


def _squeezed(content: str) -> str:
    return "".join(content.lower().split()).translate(_ALIKE)


def _has_unit(row: FormRow, composer: Composer) -> bool:
    """Return True if a cell has a unit, or a normal range: `4 pressure ga uge 8   7 - 9 bar`."""
    cells = (cell.text for cell in row.cells)
    types = ({*composer.understanding.types(text)} for text in cells)
    return any({"UNIT", "QUANTITY"} & one and one <= _OF_UNITS for one in types)


def _names_people(row: FormRow) -> bool:
    """Return True if all cells are labels with the names of people: `Off-going: D. Brandt`."""
    return all(
        (found := _LABELLED.fullmatch(cell.text.content)) is not None and is_name(found[1])
        for cell in row.cells
    )


def _is_label(row: FormRow, composer: Composer) -> bool:
    return row.labelled and not _needed(row.cells[0].text, composer)


def _needed(text: ScriptText, composer: Composer) -> list[Mention]:
    """Return what a text mentions that has an effect on a mission."""
    mentions = mentions_in(text, composer.understanding).mentions
    return [mention for mention in mentions if mention.kind not in OF_FORMS]


def _is_title(text: ScriptText, composer: Composer) -> bool:
    """Return True if the first line of a sheet, or its first cell, can be the title: `WEEKLY
    WALK-DOWN Floors 5 and 6`, `TIME PLAN RUN 12`."""
    mentions = mentions_in(text, composer.understanding)
    if pattern(r"\b<driving>\b").search(text.content) is not None:
        return False  # `Speed | slow`
    areas = [m for m in mentions.of("place") if not isinstance(m.value, tuple)]
    if areas or mentions.has("checkpoints", "pronoun", "everything"):
        return False
    capitals = text.content.split("  ")[0].isupper()
    return capitals or mentions.only(*OF_FORMS, "place", "LSQB", "RSQB")


# ---- cells


def _read_sheet_cell(cell: Cell, found: _Row, composer: Composer) -> bool:
    """Read a cell whose heading says what it holds; False for one that may name a checkpoint."""
    text = cell.text.content
    form = composer.understanding.language.prose.form
    nothing = phrase_pattern(form["nothing"]).fullmatch(text) is not None
    if phrase_pattern(form["done"]).fullmatch(text.strip(" .!")) or _TICK.fullmatch(text):
        found.doubts.append(_TICKED)
        return True
    boxes = _TICKED_BOX.sub("□", text)
    if boxes != text and _FILL.search(boxes) and not _without_fill(boxes, form):
        found.doubts.append(_TICKED)
        return True
    spare = phrase_pattern(form["leave_out"]).search(text) is not None
    if cell.filled and cell.role is CellRole.OTHER and _is_answer(text, composer):
        found.doubts.append(f"`{text}` in this column can mean that the row is not meant")
        return True
    if cell.filled and cell.role is CellRole.FILL and CLOCK.fullmatch(text):
        found.doubts.append(f"`{text}` can be a time of day at which this is done")
        return True
    if cell.filled and cell.role is CellRole.FILL and not (nothing or spare or _FILL.search(text)):
        found.doubts.append(f"`{text}` is filled in: this may be done already")
        return True
    if not nothing and _FILL.search(text) and not _without_fill(text, form):
        return True
    tag = tag_of(text)
    if cell.role is CellRole.CHECKPOINT and _CHECKPOINT.fullmatch(text):
        tag = None
    if tag is not None and cell.role in (CellRole.NAME, CellRole.CHECKPOINT, CellRole.OTHER):
        with suppress(RefusedError):
            named = mentions_in(cell.text, composer.understanding).of("checkpoints")
            found.named += composer.known.checkpoints(named)
            if named:
                return True
        found.tag = text
        return True
    match cell.role:
        case CellRole.NUMBER if _NUMBER.fullmatch(text):
            return True
        case CellRole.POINTS | CellRole.LOW | CellRole.HIGH if _PLAIN.fullmatch(text):
            return True
        case CellRole.NORMAL if nothing or _is_normal(text, form):
            return True
        case CellRole.UNIT if nothing or text.lower().strip(" .") in _ALL_UNITS:
            return True
        case CellRole.KIND if text.lower().removesuffix("s") in {str(k) for k in CheckpointKind}:
            return True
        case CellRole.FLOOR if _floors(cell.text, composer):
            return True
        case CellRole.ORDER if nothing or place_in_order(text) is not None:
            return True
        case CellRole.ORDER:
            found.doubts.append(_when(text))
            found.ordered = True
            return True
        case CellRole.PRIORITY:
            if not nothing:
                found.doubts.append(f"`{text}` can say how important this is")
            return True
        case CellRole.WINDOW:
            window = _RANGE.fullmatch(text)
            if window is None:
                found.doubts.append(f"`{text}` is not understood as minutes")
            else:
                found.manner = _window(window)
            return True
        case CellRole.CHECKPOINT if number := _CHECKPOINT.fullmatch(text):
            found.named += [c for c in composer.known.catalog.checkpoints if c.id == int(number[1])]
            if not any(c.id == int(number[1]) for c in composer.known.catalog.checkpoints):
                found.doubts.append(f"there is no checkpoint {text}")
            return True
        case CellRole.FILL | CellRole.ACTION if nothing:
            found.doubts.append(f"`{text}` can mean that this is left out")
            return True
        case CellRole.FILL if not _without_fill(text, form):
            return True
        case CellRole.REACTION:
            idle = nothing or phrase_pattern(form["no_action"]).fullmatch(text)
            found.reaction = None if idle else cell.text
            return True
        case CellRole.REMARK:
            return _read_remark(cell.text, found, composer)
    return False


def _when(content: str) -> str:
    return f"`{content}` can say when this is done"


def _may_be_time(found: re.Match[str], composer: Composer) -> bool:
    """Return True if no word beside a range, and no unit, shows that it is a normal range."""
    prose = composer.understanding.language.prose
    said = f"{found.string[: found.start()]} {found.string[found.end() :]}".strip(" ().:,")
    known = prose.role(said) == "normal" or _is_normal(said, prose.form)
    return not known and (found["unit"] or "").lower() not in _ALL_UNITS


def _window(minutes: re.Match[str]) -> str:
    """Return what a range of minutes means: when a checkpoint is read."""
    low, high = (float(minutes[k].replace(",", ".")) for k in ("low", "high"))
    latest = f" not later than {high:g} minutes after the start"
    return f" between minute {low:g} and minute {high:g}" if low else latest


def _denials(row: FormRow, composer: Composer) -> Iterator[str]:
    """Yield a doubt for `no` in a row that does not offer `yes` as well."""
    prose = composer.understanding.language.prose
    cells = [cell.text.content.lower() for cell in row.cells if cell.role is not CellRole.NUMBER]
    denied = [cell for cell in cells if cell in expand(prose.form["denied"])]
    if denied and not any(cell in expand(prose.yes) for cell in cells):
        yield f"`{denied[0]}` can mean that the row is not meant"


def _is_answer(text: str, composer: Composer) -> bool:
    """Return True if a cell has no more than `yes`, `no` or a cross."""
    prose = composer.understanding.language.prose
    return text.lower() in {*expand(prose.yes), *expand(prose.no)}


def _is_normal(text: str, form: Mapping[str, str]) -> bool:
    """Whether a cell has no more than a normal range, or the position that a valve must have."""
    if _RANGE.fullmatch(text) or _PLAIN.fullmatch(text):
        return True
    return any(phrase_pattern(form[name]).fullmatch(text) for name in _POSITIONS)


def _read_remark(text: ScriptText, found: _Row, composer: Composer) -> bool:
    found.times = _times(mentions_in(text, composer.understanding))
    if not _read_doubts(text.content, found, composer):
        if _orders(text, mentions_in(text, composer.understanding), composer):
            found.doubts.append(_when(text.content))
            found.ordered = True
        elif _asks(text, composer):
            found.doubts.append(f"`{text.content}` can change what is done here")
        else:
            found.unused.append(text.content)
    return True


def _times(found: Mentions) -> int | None:
    counts = [m.value for m in found.of("TIMES")]
    return counts[0].whole if len(counts) == 1 and isinstance(counts[0], Figure) else None


def _read_doubts(content: str, found: _Row, composer: Composer) -> bool:
    """Return True if a cell says that the row is left out, or may say so."""
    prose = composer.understanding.language.prose
    left = _without_fill(content, prose.form)
    without = missing_reading(content, prose.form)

    def has(cues: Mapping[str, str], name: str) -> bool:
        return phrase_pattern(cues[name]).search(left) is not None

    if without or phrase_pattern(prose.form["nothing"]).fullmatch(content):
        found.doubts.append(f"`{without or content}` can mean that this is left out")
    elif has(prose.form, "leave_out") or has(prose.cues, "leave_out"):
        found.left_out = True
    elif has(prose.form, "done"):
        found.doubts.append(_TICKED)
    elif has(prose.cues, "forbidding"):
        found.doubts.append(f"`{content}` can change what is done here")
    else:
        return False
    return True


def _asks(text: ScriptText, composer: Composer) -> bool:
    """Whether a remark has words of the mission language, other than first and last."""
    mentions = mentions_in(text, composer.understanding)
    if mentions.unknown and mentions.only("EVENT"):
        return False  # `lamp out of order`: of a third thing, as the checkpoint has its own cell
    return not mentions.only(*_ORDER_WORDS, "MEASURE", "courtesy")


def _orders(text: ScriptText, mentions: Mentions, composer: Composer) -> bool:
    """Return True if a text may say in which order a row is done: `first`, `3rd`, `then`; not of
    `last calibration`, which names something else."""
    content, lexicon = text.content, composer.understanding.language.lexicon
    short = len(content.split()) <= _FEW_WORDS
    if mentions.unknown and not (short or mentions.has("checkpoints")):
        return False  # `tap the glass first`
    if any(not _before_unknown(m, mentions, content) for m in mentions.of(*_ORDER_WORDS)):
        return True
    return says_order(content, lexicon)


def _before_unknown(mention: Mention, mentions: Mentions, content: str) -> bool:
    """Return True if a word that nobody knows stands directly behind a mention."""
    return any(
        mention.end <= word.start and not content[mention.end : word.start].strip()
        for word in mentions.unknown
    )


def _without_fill(text: str, form: Mapping[str, str]) -> str:
    """Return what is left of a cell without blanks to fill in and the words of forms."""
    rest = _FILL.sub(" ", text)
    furniture = phrase_pattern(form["furniture"])
    rest = furniture.sub(" ", rest)
    for name in _POSITIONS:
        if _FILL.search(text):
            rest = phrase_pattern(form[name]).sub(" ", rest)
    return rest.strip(" :.,-()%")


def _told(text: ScriptText, composer: Composer) -> list[str]:
    """Return the words of a cell that are told to have no effect where sentences have them: `on
    Monday`, `tomorrow`."""
    words = all_words(text.content, composer.understanding.language.lexicon)
    return [text.content[word.start : word.end] for word in words if word.type in TOLD]


def _read_cell(text: ScriptText, found: _Row, composer: Composer) -> None:
    """Read a cell by what it contains."""
    form = composer.understanding.language.prose.form
    content = text.content
    nothing = phrase_pattern(form["nothing"]).fullmatch(content) is not None
    if not nothing and (not _without_fill(content, form) or _RANGE.fullmatch(content)):
        return
    _read_doubts(content, found, composer)
    if nothing:
        return
    mentions = mentions_in(text, composer.understanding)
    named = mentions.of("checkpoints")
    found.together = bool(named) and not found.named
    if said := composer.known.disagreement(named):
        found.doubts.append(said)
    section = composer.known.section
    for mention in named:
        kinds = [noun for noun in mention.nouns if has_no_floor(noun)]
        with suppress(RefusedError):
            checkpoints = of_floor(mention, section, composer.known)
            if any(isinstance(noun, TheOne) for noun in kinds) and len(checkpoints) != 1:
                found.unclear = content
            found.free = not found.named and (section is not None or not kinds)
            found.free &= any(isinstance(noun, AllOf) for noun in mention.nouns)
            if len(checkpoints) == 1 and is_number(mention):
                checkpoints = list(composer.known.of_list(checkpoints[0]))
                if len(checkpoints) > 1:
                    both = " or ".join(f"{c.name} (#{c.id})" for c in checkpoints)
                    found.doubts.append(f"`{content}` can be {both}")
            found.named += checkpoints
            continue
        said = content[mention.start : mention.end]
        found.doubts.append(f"it is not clear which checkpoint `{said}` is")
    if not named and _NUMBER.fullmatch(content):
        return
    ranged = _RANGE.search(content)
    if not named and mentions.has("SPAN"):
        found.span = text
    elif not named and ranged is not None and _may_be_time(ranged, composer):
        found.window = _window(ranged)  # `T 10 to 15`, where no heading says what that is
        found.doubts.append(f"`{content}` can be a time, or a normal range")
        return
    unused = [*_unused(content, mentions, form)]
    found.unused += unused or _told(text, composer) or mentions.idle
    if _orders(text, mentions, composer):
        found.doubts.append(_when(content))
        found.ordered = True
        return
    found.unused += [content[m.start : m.end] for m in mentions.of(*_ORDER_WORDS)]
    others = [m for m in mentions.mentions if m.kind not in (*_IDLE, *_ORDER_WORDS)]
    made = composer.propose(text).sentences if others and named else ()
    asked = content.rstrip().endswith("?")
    if made and not found.sentences:
        found.sentences = made
    elif others and not asked:  # `Is valve R25 open?`
        found.times = _times(mentions)
        said = content[others[0].start : others[0].end] or content
        found.doubts.append(f"`{said}` is not understood here")


def _after_row(text: ScriptText, id: int, composer: Composer) -> Iterator[Sentences]:
    """Yield what `10 to 15 min after step 1` says of a checkpoint, if step 1 was read last."""
    items, said = composer.known.items, text
    mentions = mentions_in(text, composer.understanding).mentions
    for step, number in reversed(list(pairwise(mentions))):
        other = items.get(text.content[number.start : number.end])
        if step.kind == "STEP" and other is not None:
            said = said.replace(step.start, number.end, f"#{other}")
    with composer.known.unchanged():
        made = composer.propose(text.replaced(f"#{id} {said.content}")).sentences
    yield from (made,) if made else ()


def of_floor(mention: Mention, section: Mention | None, known: Known) -> Sequence[CheckpointInfo]:
    """Return the checkpoints that a part of a row names; `all valves`, and `the valve` if it is the
    only one, are those on the floor of the heading above. What another row names is not meant."""
    nouns = mention.value
    assert isinstance(nouns, Nouns)
    if not any(map(has_no_floor, nouns.nouns)):
        return known.checkpoints([mention])
    if section is None:
        alone = any(isinstance(noun, TheOne) for noun in nouns.nouns)
        return [] if alone else known.checkpoints([mention])
    every = (AllOf(span=n.span, kind=n.kind) if isinstance(n, TheOne) else n for n in nouns.nouns)
    there = replace(mention, value=replace(nouns, nouns=tuple(every)))
    return placed([there], [section], known) or []


def _unused(content: str, mentions: Mentions, form: Mapping[str, str]) -> Iterator[str]:
    """Yield the phrases that say more than that a checkpoint is read, and in which state it should
    be: `call the operator`, not `call` alone. They end where a word is used."""
    used = [fill.span() for fill in _FILL.finditer(content)]
    used += [(m.start, m.end) for m in mentions.mentions if m.kind not in _BESIDE]
    for name in (*_POSITIONS, "furniture"):
        used += [word.span() for word in phrase_pattern(form[name]).finditer(content)]
    asking = [word.span() for word in phrase_pattern(form["asking"]).finditer(content)]
    spans = [(word.start, word.end) for word in mentions.unknown]
    more = [span for span in spans if not _overlap(span, [*used, *asking])]
    spans = [(m.start, m.end) for m in mentions.mentions if m.kind in _BESIDE and m.start < m.end]
    spans = sorted([*more, *(span for span in spans if not _overlap(span, [*used, *asking]))])
    first = 0
    for start, end in (*sorted(used), (len(content), len(content))):
        phrase = [span for span in spans if first <= span[0] < start]
        if any(span in more for span in phrase):
            yield content[phrase[0][0] : phrase[-1][1]]
        first = max(first, end)


def _overlap(span: tuple[int, int], others: Sequence[tuple[int, int]]) -> bool:
    return any(start < span[1] and span[0] < end for start, end in others)


def _unexplained(row: FormRow, named: Mapping[int, CheckpointInfo]) -> Iterator[str]:
    """Yield the numbers and letters of a row under headings that nobody knows, but for what the
    site has: the number of the checkpoint, both ends of its normal range and, in a row without
    headings, its floor; below `Team` a number is none."""
    known: set[str] = set()
    floors = {str(one.floor) for one in named.values()}
    said = {cell.text.content.strip() for cell in row.cells}
    for one in named.values():
        ends = {f"{one.nominal.low:g}", f"{one.nominal.high:g}"}
        known |= {
            str(one.id),
            one.name.split()[-1],
            *(ends if ends <= said else ()),
        }
    for cell in row.cells[1:]:
        content = cell.text.content.strip()
        explained = content in known or (cell.column is None and content in floors)
        if cell.role is CellRole.OTHER and _BARE.fullmatch(content) and not explained:
            yield content


# ---- what the site knows of the checkpoint


def _compare(
    cells: Sequence[Cell], checkpoint: CheckpointInfo, found: _Row, composer: Composer
) -> None:
    """Compare floors, units, kinds, positions and ranges with those of the site."""
    form = composer.understanding.language.prose.form
    by_role = {cell.role: cell.text.content for cell in cells}
    unit = by_role.get(CellRole.UNIT, "")
    for cell in cells:
        content = cell.text.content
        lowered = content.lower().strip(" .")
        match cell.role:
            case CellRole.FLOOR:
                floors = _floors(cell.text, composer)
                if floors and checkpoint.floor not in floors:
                    found.doubts.append(f"{checkpoint.name} is on floor {checkpoint.floor}")
                elif not floors:
                    found.unused.append(content)
            case CellRole.UNIT if lowered not in _UNITS[checkpoint.kind]:
                found.unused.append(content)
            case CellRole.KIND if lowered not in (str(checkpoint.kind), str(checkpoint.kind) + "s"):
                found.doubts.append(f"checkpoint {checkpoint.id} is {checkpoint.name}")
        if cell.role in (CellRole.NORMAL, CellRole.OTHER, CellRole.NAME):
            has_unit = cell.role is not CellRole.NORMAL or _PLAIN_RANGE.fullmatch(content) is None
            found.differences += _range_difference(
                content if has_unit else f"{content} {unit}", checkpoint
            )
            if checkpoint.kind is CheckpointKind.VALVE:
                found.differences += _position_difference(content, checkpoint, form)
    low, high = by_role.get(CellRole.LOW), by_role.get(CellRole.HIGH)
    if low and high and _PLAIN.fullmatch(low) and _PLAIN.fullmatch(high):
        found.differences += _range_difference(f"{low} - {high} {unit}", checkpoint)


def _floors(text: ScriptText, composer: Composer) -> set[int]:
    if text.content.isdecimal():
        return {int(text.content)}
    places = mentions_in(text, composer.understanding).of("place")
    found: set[int] = set()
    for place in places:
        if isinstance(place.value, tuple):
            with suppress(RefusedError):
                found |= composer.known.floors([f for f in place.value if isinstance(f, FloorName)])
    return found


def _range_difference(content: str, checkpoint: CheckpointInfo) -> Iterator[str]:
    said = _RANGE.search(content)
    if said is None:
        return
    unit = (said["unit"] or "").lower().strip(".,;)")
    factor = _BAR.get(unit, 1.0) if checkpoint.kind is CheckpointKind.PRESSURE_GAUGE else 1.0
    low, high = (float(said[k].replace(",", ".")) * factor for k in ("low", "high"))
    known = checkpoint.nominal
    if unit in _ALL_UNITS - _UNITS[checkpoint.kind]:
        yield (
            f"the normal range of {checkpoint.name} is in {unit} here, "
            f"but in {checkpoint.unit} on the site"
        )
    elif abs(low - known.low) > 1e-6 or abs(high - known.high) > 1e-6:
        yield (
            f"the normal range of {checkpoint.name} is {low:g} to {high:g} here, "
            f"but {known.low:g} to {known.high:g} {checkpoint.unit} on the site"
        )


def _position_difference(
    content: str, checkpoint: CheckpointInfo, form: Mapping[str, str]
) -> Iterator[str]:
    known = checkpoint.nominal
    for name in _POSITIONS:
        if phrase_pattern(form[name]).search(content) is None:
            continue
        fits = {
            "open": known.low >= _OPEN,
            "closed": known.high <= _CLOSED,
            "half": known.low > _CLOSED and known.high < _OPEN,
        }[name]
        if not fits and "/" not in content:
            yield (
                f"{checkpoint.name} is {name} here, but {known.low:g} to {known.high:g}° is normal "
                "on the site"
            )
        return
