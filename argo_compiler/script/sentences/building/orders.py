"""Makes orders."""

from dataclasses import replace

from argo_compiler.script.sentences.building.manners import combined
from argo_compiler.script.sentences.building.nouns import named
from argo_compiler.script.sentences.building.part import Make, RulePart, duration, whole
from argo_compiler.script.sentences.tree import orders
from argo_compiler.script.sentences.tree.manner import Manner
from argo_compiler.script.sentences.tree.nouns import Labelled, Nouns, Pronoun
from argo_compiler.script.sentences.tree.orders import ScriptOrder, Side
from argo_compiler.script.sentences.tree.places import (
    AreaLocation,
    Coordinates,
    DockLocation,
    FloorName,
    Location,
    PlaceLocation,
    Steps,
)
from argo_compiler.script.sentences.words.loading import pattern
from argo_compiler.script.sentences.words.word import Word

_WHEREABOUTS = r"\b<whereabouts>\b"
"""words that say where something is, and not where to: `on the second floor`"""


def _manner(part: RulePart) -> Manner:
    return combined(part, part.every(Manner))


def _order(part: RulePart) -> ScriptOrder:
    found = part.the(ScriptOrder)
    name = part.word("STRING")
    if name is None:
        return found
    if not name.value:
        hint = "write a name between the quotation marks, or remove them"
        part.error("empty-name", "this name is empty", hint)
    return replace(found, name=name.value)


def _measure(part: RulePart) -> ScriptOrder:
    what, *but = part.every(Nouns)
    if but:
        what = replace(what, but=(*what.but, *but[0].but))
    manner = _manner(part)
    if what.parted and manner.condition is not None:
        message = "this condition can apply to the last of these only, or to both"
        hint = "write a sentence for each: `check #1. Check #4 only if #1 is above 4`, or remove "
        hint += "the comma"
        part.error("ambiguous-manner", message, hint)
    return orders.Measure(
        span=part.span,
        manner=manner,
        what=what,
        bare=not part.has("MEASURE", "KEEP_MEASURING", "BE_MEASURED", "ADD"),
        keep=part.has("KEEP_MEASURING"),
        passive=part.has("BE_MEASURED"),
    )


def _go(part: RulePart) -> ScriptOrder:
    where_to = where(part)
    order = _towards(part, where_to)
    driven = order.manner.speed is not None
    if isinstance(where_to, FloorName) and driven and pattern(_WHEREABOUTS).search(part.said):
        message = "this floor can be the destination, or where the speed applies"
        hint = "write `go to floor 2` for the first, the speed after each command for the second"
        part.error("ambiguous-place", message, hint)
    return order


def where(part: RulePart) -> Location | FloorName:
    """The place that a rule names; the area of a docking station may stand in brackets."""
    found = part.first(DockLocation)
    inside = part.every(AreaLocation)[-1:] if part.has("LPAR") else ()
    if inside:
        if found is None or found.area is not None:
            part.error("several-places", "this names two places", "remove one of the two")
            return inside[0]
        return replace(found, area=inside[0])
    for child in part.children:
        if isinstance(child, tuple):
            floor: FloorName = child[0]
            others = child[1:]
            if others:
                message = "the robot can go to only one floor at a time"
                part.error("several-floors", message, "write a command for each of them")
            return floor
        if isinstance(child, AreaLocation | DockLocation | PlaceLocation | Coordinates):
            return child
    raise AssertionError("the grammar lets the place be left out")


def _towards(part: RulePart, where: Location | FloorName) -> ScriptOrder:
    if isinstance(where, DockLocation):
        return orders.Home(span=part.span, manner=_manner(part), dock=where)
    return orders.Go(span=part.span, manner=_manner(part), where=where)


def _home(part: RulePart) -> ScriptOrder:
    """`Go home`, `return to the docking station`, `dock in starting area 1`."""
    named = any(not isinstance(child, Word | Manner) for child in part.children)
    place = where(part) if named else DockLocation(span=part.span)
    if isinstance(place, AreaLocation):
        place = DockLocation(span=part.span, area=place)
    return _towards(part, place)


def _start(part: RulePart) -> ScriptOrder:
    place = where(part)
    if isinstance(place, FloorName):
        hint = "name a starting area or a position: `start in starting area 1`"
        part.error("start", "a mission can't start anywhere on a floor", hint)
        return orders.Start(span=part.span, where=None)
    ends = part.has("END")
    return orders.Start(span=part.span, manner=_manner(part), where=place, ends_there=ends)


def _patrol(part: RulePart) -> ScriptOrder:
    places = next(c for c in part.children if isinstance(c, list))
    said = part.every(Manner)
    if rounds := part.word("NUMBER"):
        said = (Manner(times=whole(part, rounds.value)), *said)
    return orders.Patrol(span=part.span, manner=combined(part, said), places=tuple(places))


def _word(part: RulePart) -> ScriptOrder:
    word = orders.PlainWord[part.children[0].type]
    return orders.Plain(span=part.span, manner=_manner(part), word=word)


def _retry(part: RulePart) -> ScriptOrder:
    again = part.the_word("RETRY").value == "again"
    every = part.has("ALL")
    return orders.Retry(span=part.span, manner=_manner(part), again=again, every=every)


def _repeat(part: RulePart) -> ScriptOrder:
    return orders.Repeat(
        span=part.span,
        manner=_manner(part),
        steps=part.first(Steps),
        last=part.first(Pronoun) is not None,
        again=part.the_word("REPEAT").value == "again",
    )


def _wait(part: RulePart) -> ScriptOrder:
    here = all(isinstance(c, Word | Manner) for c in part.children)
    place = None if here else where(part)
    verb = part.word("WAIT")
    stays = verb is not None and verb.value == "stay"
    return orders.WaitOrder(span=part.span, manner=_manner(part), where=place, stays=stays)


def _things(part: RulePart) -> list[Nouns | Steps]:
    return [c for c in part.children if isinstance(c, Nouns | Steps)]


def _add(part: RulePart) -> ScriptOrder:
    what, anchor = _things(part)
    if isinstance(part.children[0], Side):  # `after step 2, insert checkpoint 20`
        what, anchor = anchor, what
    assert isinstance(what, Nouns)
    return orders.Add(
        span=part.span, manner=_manner(part), what=what, side=part.the(Side), anchor=anchor
    )


def _target(part: RulePart) -> Nouns:
    (noun,) = named(part)
    return Nouns(span=part.span, nouns=(noun,))


def _visit(part: RulePart) -> ScriptOrder:
    """`Go to the second floor to valve R12`."""
    what = part.the(Nouns)
    if floors := part.first(tuple):
        (target,) = what.nouns
        assert isinstance(target, Labelled)
        what = replace(what, nouns=(replace(target, floors=floors),))
    if part.has("BE_MEASURED"):  # `go to valve R12, which is to be checked`
        return orders.Measure(span=part.span, manner=_manner(part), what=what)
    return orders.VisitOrder(span=part.span, manner=_manner(part), what=what)


def _move(part: RulePart) -> ScriptOrder:
    what, anchor = _things(part)
    return orders.Move(span=part.span, what=what, side=part.the(Side), anchor=anchor)


def _replace(part: RulePart) -> ScriptOrder:
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
    "start_here": lambda part: orders.Start(
        span=part.span, manner=_manner(part), where=part.first(Coordinates), here=True
    ),
    "patrol": _patrol,
    "wait": _wait,
    # `wait 1 minute between two readings`: said of the rounds before
    "waits_between": lambda part: orders.Amend(span=part.span, manner=Manner(pause=duration(part))),
    "target": _target,
    "visit": _visit,
    "beside": lambda part: orders.Beside(
        span=part.span,
        order=part.the(orders.Measure),
        side=part.the(Side),
        anchor=part.the(Nouns),
    ),
    "spare": lambda part: orders.Spare(span=part.span, what=part.the(Nouns)),
    "word": _word,
    "retry": _retry,
    "repeat": _repeat,
    "follow": lambda part: orders.Follow(span=part.span, manner=_manner(part)),
    "amend": lambda part: orders.Amend(span=part.span, manner=_manner(part)),
    "add": _add,
    "delete": lambda part: orders.Delete(span=part.span, what=_things(part)[0]),
    "move": _move,
    "replace": _replace,
    "side": lambda part: Side.BEFORE if part.has("BEFORE") else Side.AFTER,
}
