"""Makes orders."""

from dataclasses import replace

from argo_compiler.script.syntax.building.figures import whole
from argo_compiler.script.syntax.building.manners import combined
from argo_compiler.script.syntax.building.nouns import named
from argo_compiler.script.syntax.building.part import Make, Part
from argo_compiler.script.syntax.tree import orders
from argo_compiler.script.syntax.tree.manner import Manner
from argo_compiler.script.syntax.tree.nouns import Nouns, Pronoun
from argo_compiler.script.syntax.tree.orders import Order, Side
from argo_compiler.script.syntax.tree.places import (
    AreaLocation,
    Coordinates,
    DockLocation,
    FloorName,
    Location,
    PlaceLocation,
    Steps,
)
from argo_compiler.script.syntax.words.word import Word

_WORDS = {
    "PAUSE": orders.Word.PAUSE,
    "END": orders.Word.END,
    "ABORT": orders.Word.ABORT,
    "GO_ON": orders.Word.GO_ON,
    "RECHARGE": orders.Word.RECHARGE,
    "REPORT": orders.Word.REPORT,
    "DONE": orders.Word.DONE,
    "MEET": orders.Word.MEET,
}


def _manner(part: Part) -> Manner | None:
    return combined(part, part.every(Manner))


def _order(part: Part) -> Order:
    found = part.the(Order)
    name = part.word("STRING")
    if name is None:
        return found
    if not name.value:
        hint = "write a name between the quotation marks, or leave them out"
        part.error("empty-name", "this name is empty", hint)
    return replace(found, name=name.value)


def _measure(part: Part) -> Order:
    return orders.Measure(
        span=part.span,
        manner=_manner(part),
        what=part.the(Nouns),
        bare=not part.has("MEASURE", "KEEP_MEASURING", "BE_MEASURED", "ADD"),
        keep=part.has("KEEP_MEASURING"),
    )


def _go(part: Part) -> Order:
    return _towards(part, where(part))


def where(part: Part) -> Location | FloorName:
    """The place that a rule names."""
    for child in part.children:
        if isinstance(child, tuple):
            floor: FloorName = child[0]
            others = child[1:]
            if others:
                message = "the robot can go to one floor at a time"
                part.error("several-floors", message, "write an order for each of them")
            return floor
        if isinstance(child, AreaLocation | DockLocation | PlaceLocation | Coordinates):
            return child
    raise AssertionError("the grammar lets the place be left out")


def _towards(part: Part, where: Location | FloorName) -> Order:
    if isinstance(where, DockLocation):
        return orders.Home(span=part.span, manner=_manner(part), dock=where)
    return orders.Go(span=part.span, manner=_manner(part), where=where)


def _home(part: Part) -> Order:
    """`Go home`, `return to the docking station`, `dock in starting area 1`."""
    named = any(not isinstance(child, Word | Manner) for child in part.children)
    place = where(part) if named else DockLocation(span=part.span)
    if isinstance(place, AreaLocation):
        place = DockLocation(span=part.span, area=place)
    return _towards(part, place)


def _start(part: Part) -> Order:
    place = where(part)
    if isinstance(place, FloorName):
        hint = "name a starting area or a place: `start in starting area 1`"
        part.error("start", "a mission starts at a place", hint)
        return orders.Start(span=part.span, where=None)
    ends = part.has("END")
    return orders.Start(span=part.span, manner=_manner(part), where=place, ends_there=ends)


def _start_here(part: Part) -> Order:
    where = part.first(Coordinates)
    return orders.Start(span=part.span, manner=_manner(part), where=where, here=True)


def _patrol(part: Part) -> Order:
    places = next(c for c in part.children if isinstance(c, list))
    said = part.every(Manner)
    if rounds := part.word("NUMBER"):
        said = (Manner(times=whole(part, rounds.value)), *said)
    return orders.Patrol(span=part.span, manner=combined(part, said), places=tuple(places))


def _word(part: Part) -> Order:
    word = _WORDS[part.children[0].type]
    return orders.Plain(span=part.span, manner=_manner(part), word=word)


def _repeat(part: Part) -> Order:
    return orders.Repeat(
        span=part.span,
        manner=_manner(part),
        steps=part.first(Steps),
        last=part.first(Pronoun) is not None,
    )


def _wait(part: Part) -> Order:
    here = all(isinstance(c, Word | Manner) for c in part.children)
    place = None if here else where(part)
    manner = _manner(part)
    person = manner is not None and manner.person
    return orders.Wait(span=part.span, manner=manner, where=place, person=person)


def _things(part: Part) -> list[Nouns | Steps]:
    return [c for c in part.children if isinstance(c, Nouns | Steps)]


def _side(part: Part) -> Side:
    return Side.BEFORE if part.has("BEFORE") else Side.AFTER


def _add(part: Part) -> Order:
    what, anchor = _things(part)
    if isinstance(part.children[0], Side):  # `after step 2, insert checkpoint 20`
        what, anchor = anchor, what
    assert isinstance(what, Nouns)
    return orders.Add(
        span=part.span, manner=_manner(part), what=what, side=part.the(Side), anchor=anchor
    )


def _delete(part: Part) -> Order:
    return orders.Delete(span=part.span, what=_things(part)[0])


def _target(part: Part) -> Nouns:
    (noun,) = named(part)
    return Nouns(span=part.span, nouns=(noun,))


def _visit(part: Part) -> Order:
    return orders.Visit(span=part.span, manner=_manner(part), what=part.the(Nouns))


def _spare(part: Part) -> Order:
    return orders.Spare(span=part.span, what=part.the(Nouns))


def _move(part: Part) -> Order:
    what, anchor = _things(part)
    return orders.Move(span=part.span, what=what, side=part.the(Side), anchor=anchor)


def _replace(part: Part) -> Order:
    what, by = _things(part)
    assert isinstance(by, Nouns)
    return orders.Replace(span=part.span, what=what, by=by)


RULES: dict[str, Make] = {
    "order": _order,
    "measure": _measure,
    "append": _measure,
    "keep": _measure,
    "bare": _measure,
    "passive": _measure,
    "go": _go,
    "jump": lambda part: orders.Jump(span=part.span, step=part.the(Steps)),
    "home": _home,
    "start": _start,
    "start_here": _start_here,
    "patrol": _patrol,
    "wait": _wait,
    "target": _target,
    "visit": _visit,
    "spare": _spare,
    "word": _word,
    "retry": lambda part: orders.Retry(span=part.span, manner=_manner(part)),
    "repeat": _repeat,
    "follow": lambda part: orders.Follow(span=part.span, manner=_manner(part)),
    "amend": lambda part: orders.Amend(span=part.span, manner=_manner(part)),
    "add": _add,
    "delete": _delete,
    "move": _move,
    "replace": _replace,
    "side": _side,
}
