"""Frames: what kinds of texts ask for, by what they mention.

Each frame returns its sentences, or None if a text mentions anything that the frame does not use.
"""

from collections.abc import Callable, Sequence
from contextlib import suppress

from argo_compiler.base.catalog import CheckpointInfo, CheckpointKind
from argo_compiler.script.documents.source import RefusedError
from argo_compiler.script.proposals.known import Known
from argo_compiler.script.proposals.mentions import Mention, Mentions, checkpoint_words
from argo_compiler.script.sentences.tree.nouns import (
    AllOf,
    Kind,
    Noun,
    Nouns,
    Pronoun,
    Quantity,
    TheOne,
)
from argo_compiler.script.sentences.tree.places import AreaLocation, DockLocation, FloorName
from argo_compiler.script.sentences.words.amounts import Length
from argo_compiler.script.sentences.words.numbers import Figure

Sentences = tuple[str, ...]
KINDS: dict[Quantity | None, CheckpointKind] = {
    Quantity.PRESSURE: CheckpointKind.PRESSURE_GAUGE,
    Quantity.LEVEL: CheckpointKind.LIQUID_LEVEL_GAUGE,
    Quantity.POSITION: CheckpointKind.VALVE,
}
"""the kind of checkpoint that shows a quantity"""
_LONGEST_S = 1e7
_MOST_READINGS = 10
"""of one checkpoint, one after the other"""


def sentences_of(found: Mentions, known: Known) -> Sentences | None:
    """Return what the first frame makes that fits; no sentences if nothing is left to do."""
    made = (frame(found, known) for frame in _FRAMES)
    return next((sentences for sentences in made if sentences is not None), None)


def _leave_out(found: Mentions, known: Known) -> Sentences | None:
    """`skip PG 7, no ladder there`, `valve R12 is not needed`"""
    if not found.has("leave_out", "SPARE", "DELETE"):
        return None
    idle = [m for m in found.of("forbidding", "correction") if _before_unknown(m, found)]
    kept = Mentions(tuple(m for m in found.mentions if m not in idle), found.unknown)
    allowed = ("leave_out", "SPARE", "DELETE", "checkpoints", "place", "BE_MEASURED", "pronoun")
    if not kept.only(*allowed):
        return None
    with suppress(RefusedError):
        named = known.checkpoints(kept.of("checkpoints"))
        if not kept.has("checkpoints"):
            last = known.last_named
            verbs = kept.of("leave_out", "SPARE", "DELETE")
            others = [word for word in kept.unknown if word.start < verbs[0].start]
            meant = kept.has("pronoun") or not others
            fits = last is not None and all(_may_be(m, last) for m in kept.of("pronoun"))
            named = [last] if last is not None and meant and fits else []
        if named:
            return _spare(named, known)
    return None


def _may_be(pronoun: Mention, checkpoint: CheckpointInfo) -> bool:
    """Return True if a pronoun can mean a checkpoint: `the pressure` is that of a gauge."""
    quantities = [noun.quantity for noun in pronoun.nouns if isinstance(noun, Pronoun)]
    return all(KINDS.get(quantity, checkpoint.kind) is checkpoint.kind for quantity in quantities)


def _spare(named: Sequence[CheckpointInfo], known: Known) -> Sentences:
    """Return how checkpoints are left out: those that are asked for above are deleted. Nothing
    is said of those that are left out by now."""
    new = [c for c in named if c.id not in known.spared | known.deleted | known.excepted]
    above = [c for c in new if c.id in known.memory.so_far]
    others = [c for c in new if c.id not in known.memory.so_far]
    known.deleted |= {c.id for c in above}
    known.spared |= {c.id for c in others}
    pairs = (("Delete", above), ("Do not check", others))
    return tuple(f"{verb} {checkpoint_words(some)}." for verb, some in pairs if some)


def _replace(found: Mentions, known: Known) -> Sentences | None:
    """`sorry, not R25 but R12 in step 2`, `R12 instead of R25`, where that is asked for."""
    named = found.of("checkpoints")
    denials = ("forbidding", "NOT", "EXCEPT", "in_place_of")
    allowed = ("checkpoints", "STEP", "NUMBER", "place", "correction", "BUT", *denials)
    if len(named) != 2 or not found.has("correction", "in_place_of") or not found.only(*allowed):
        return None
    before = [m for m in found.of(*denials) if m.end <= named[0].start]
    between = [m for m in found.of(*denials) if named[0].end <= m.start < named[1].start]
    if bool(before) == bool(between):
        return None
    with suppress(RefusedError):
        (first,), (second,) = (known.checkpoints([one]) for one in named)
        old, new = (first, second) if before else (second, first)
        if not found.has("correction") and old.id not in known.asked | known.memory.so_far.keys():
            return None
        return (f"Replace checkpoint {old.id} by checkpoint {new.id}.",)
    return None


def _in_the_same_area(found: Mentions, known: Known) -> Sentences | None:
    """`End: docking station, same area`"""
    allowed = ("same_area", "last", "home", "HOME", "END", "DOCK", "place", "AREA")
    areas = [m for m in found.of("place") if _area_of(m) is not None]
    if known.start_area is None or not found.has("same_area") or not found.only(*allowed):
        return None
    return None if areas else (f"End of the mission: starting area {known.start_area}.",)


def _go(found: Mentions, known: Known) -> Sentences | None:
    """`start in area 1, go to liquid level gauge 2`, below which that is read."""
    named, places = found.of("checkpoints"), found.of("place")
    if not named or not found.has("GO") or len(places) != 1:
        return None
    started = _start_and_end(found.without("checkpoints", "GO"), known)
    if started is None or not found.only("checkpoints", "GO", "place", "start", "START", "FROM"):
        return None
    with suppress(RefusedError):
        known.measured(known.checkpoints(named))
        return started
    return None


def _between_after(found: Mentions, known: Known) -> Sentences | None:
    """`Read pressure gauge 7 at least 5 but at most 8 minutes after pressure gauge 6`, where
    that is what was read last."""
    spans, named = found.of("SPAN"), found.of("checkpoints")
    if len(spans) != 1 or len(named) != 2 or not found.only("SPAN", "checkpoints", "MEASURE"):
        return None
    with suppress(RefusedError):
        checked, other = (known.checkpoints([one]) for one in named)
        least_s, most_s = spans[0].limits_s
        if (
            tuple(other) != known.memory.last
            or len(checked) != 1
            or spans[0].start > named[1].start
        ):
            return None
        known.measured(checked)
        wait = f"Wait for {seconds_words(least_s)}."
        return (
            wait,
            f"Check checkpoint {checked[0].id}, taking at most {seconds_words(most_s - least_s)}.",
        )
    return None


def _later(found: Mentions, known: Known) -> Sentences | None:
    """`Ten minutes later read valve R18`"""
    lengths, named = found.of("DURATION"), found.of("checkpoints")
    if len(lengths) != 1 or not found.has("later") or not named:
        return None
    if not found.only("DURATION", "later", "checkpoints", "MEASURE", "again", "MORE"):
        return None
    text = length_words(lengths[0].value)
    checked = _check(found.without("DURATION", "later"), known)
    if text is None or checked is None or lengths[0].start > named[0].start:
        return None
    return (f"Wait for {text}.", *checked)


def _spaced(found: Mentions, known: Known) -> Sentences | None:
    """`pressure gauge 3: two readings, ten minutes apart`"""
    lengths, counts = found.of("DURATION"), found.of("NUMBER", "TIMES")
    spacing = ("later", "IN_BETWEEN", "PAUSE_OF")
    if len(lengths) != 1 or len(counts) != 1 or not found.has(*spacing):
        return None
    allowed = ("DURATION", "NUMBER", "TIMES", "checkpoints", "MEASURE", "pronoun", *spacing)
    count = counts[0].value
    text = length_words(lengths[0].value)
    if not found.only(*allowed) or not isinstance(count, Figure) or text is None:
        return None
    checked = _check(found.without("DURATION", "NUMBER", "TIMES", "pronoun", *spacing), known)
    if checked is None or count.whole is None or not 1 < count.whole <= _MOST_READINGS:
        return None
    return (*checked, *((f"Wait for {text}.", *checked) * (count.whole - 1)))


def _check(found: Mentions, known: Known) -> Sentences | None:
    """Checkpoints, and nothing else than that they are read, and how often."""
    named = found.of("checkpoints")
    allowed = (
        "MEASURE",
        "BE_MEASURED",
        "measuring",
        "TIMES",
        "last",
        "first",
        "GO",
        "place",
        "OF",
        "VALUE",
        "each",
        "IF_TIME",
        "BOTH",
    )
    if not found.only("checkpoints", "pronoun", "MORE", "again", *allowed):
        return None
    if not named:
        named = found.of("pronoun")
        if not named or not found.has("MEASURE", "again", "MORE"):
            return None
    if _verb_before(found, named[-1]) or _words_between(found, named):
        return None
    if (found.has("measuring") and found.announces) or any(map(_announces, named)):
        return None  # `It takes these checkpoints:`
    if found.has("first") and known.memory.so_far:
        return None
    with suppress(RefusedError):
        checkpoints = placed(named, found.of("place"), known)
        if checkpoints is None or (found.has("BOTH") and len(checkpoints) != _BOTH):
            return None
        return _checks(named, checkpoints, found, known)
    return None


def _checks(
    named: Sequence[Mention],
    checkpoints: Sequence[CheckpointInfo],
    found: Mentions,
    known: Known,
) -> Sentences | None:
    """Return that checkpoints are read, once or several times; the order of `all gauges` is
    free."""
    counts = [m.value for m in found.of("TIMES")]
    if len(counts) > 1 or not all(isinstance(count, Figure) for count in counts):
        return None
    times = counts[0].whole if counts and isinstance(counts[0], Figure) else 1
    if times != 1 and ((len(checkpoints) > 1 and not found.has("each")) or found.has("IF_TIME")):
        return None
    nouns = [noun for mention in named for noun in mention.nouns]
    all_of_kind = found.has("BOTH") or any(isinstance(noun, AllOf) for noun in nouns)
    free = len(checkpoints) > 1 and all_of_kind
    known.measured(checkpoints)
    if times == 1:
        manner = " in any order" if free else " if there is time" if found.has("IF_TIME") else ""
        check = f"heck {checkpoint_words(checkpoints)}{manner}."
        return (f"At the end, c{check}" if found.has("last") else f"C{check}",)
    return tuple(f"Check checkpoint {c.id} {times} times." for c in checkpoints)


def _floors(found: Mentions, known: Known) -> Sentences | None:
    """`Inspect floor 2`: all that is there."""
    places = found.of("place")
    floors = [floor for place in places for floor in floor_names(place)]
    plain = found.has("MEASURE") and found.only("MEASURE", "place") and not found.unknown
    if not (plain and floors and all(map(floor_names, places))):
        return None
    with suppress(RefusedError):
        numbers = known.floors(floors)
        checkpoints = [c for c in known.catalog.checkpoints if c.floor in numbers]
        if checkpoints:
            known.measured(checkpoints)
            return (f"Check {checkpoint_words(checkpoints)}.",)
    return None


def placed(
    named: Sequence[Mention], places: Sequence[Mention], known: Known
) -> list[CheckpointInfo] | None:
    """Return the checkpoints, each of which is on the floor named beside it; None if one is
    not. A floor before `all valves` says which are meant."""
    floors = [place for place in places if isinstance(place.value, tuple)]
    if len(floors) < len(places):
        return None
    if len(floors) == 1 and len(named) == 1 and isinstance(named[0].value, Nouns):
        nouns = named[0].value
        if all(map(has_no_floor, nouns.nouns)):
            resolver = known.resolver()
            return resolver.all(resolver.on(floor_names(floors[0]), nouns))
    checkpoints = known.checkpoints(named)
    for place in floors:
        before = [m for m in named if m.start < place.start] or list(named)
        near = known.checkpoints(before[-1:]) if len(floors) > 1 else checkpoints
        if not {c.floor for c in near} <= known.floors(floor_names(place)):
            return None
    return checkpoints


def _announces(named: Mention) -> bool:
    """Return True for `Checkpoints to visit`, without which ones."""
    return any(
        isinstance(n, TheOne) and n.kind is Kind.CHECKPOINT and n.plural and not n.floors
        for n in named.nouns
    )


def has_no_floor(noun: Noun) -> bool:
    """Return True for `all gauges` or `the gauge`, if no floor is named."""
    return isinstance(noun, AllOf | TheOne) and not noun.floors


def floor_names(place: Mention) -> list[FloorName]:
    """Return the floors of a place; none if it is another place."""
    places = place.value if isinstance(place.value, tuple) else ()
    return [floor for floor in places if isinstance(floor, FloorName)]


def _duration(found: Mentions, _: Known) -> Sentences | None:
    """`keep it under 15 minutes`, `the whole test must be over after 90 minutes`"""
    lengths = found.of("DURATION", "MOST_TIME")
    limits = ("limit", "MOST_TIME", "LESS", "MAX_DURATION", "WITHIN", "AT_MOST")
    allowed = ("DURATION", "TOTAL", "TIME_WORD", "pronoun", "everything", "MEASURE", *limits)
    if found.has("over", "GREATER") and found.has("forbidding", "NOT"):  # `not longer than`
        found = found.without("over", "GREATER", "forbidding", "NOT")
    elif not found.has(*limits):
        return None
    if len(lengths) != 1 or not found.only(*allowed):
        return None
    text = length_words(lengths[0].value)
    return None if text is None else (f"Maximum duration: {text}.",)


def _start_and_end(found: Mentions, _: Known) -> Sentences | None:
    """`start in area 1`, `from area 2, back to its dock`"""
    allowed = ("place", "start", "home", "START", "FROM", "HOME", "DOCK", "END", "last", "GO")
    if found.has("EXACTLY"):  # `minute 0 = start from area 1`
        zero = [m for m in found.of("DURATION") if length_words(m.value) is None]
        found = found.without("EXACTLY", "DURATION") if len(zero) == 1 else found
    if found.has("DO_FOLLOWING", "THIS_ORDER"):  # over a list
        found = found.without("DO_FOLLOWING", "MEASURE", "KIND")
    if not found.only(*allowed, "pronoun"):
        return None
    areas = [m for m in found.of("place") if isinstance(m.value, AreaLocation | DockLocation)]
    if len(areas) != len(found.of("place")):
        return None
    if any(isinstance(m.value, AreaLocation) for m in areas):  # `its dock, area 1`
        areas = [m for m in areas if _area_of(m) is not None]
    docks = [m for m in areas if isinstance(m.value, DockLocation)]
    starts, homes = found.of("start", "START", "FROM"), found.of("home", "HOME", "END")
    if starts and not homes and len(areas) == 1:
        area = _area_of(areas[0])
        return None if area is None else (f"Start in starting area {area}.",)
    if (homes or docks) and not starts and _may_be_in_case(found, [*homes, *docks]):
        return None
    if (homes or docks) and not starts and len(areas) <= 1:
        area = _area_of(areas[0]) if areas else None
        where = f" in starting area {area}" if area is not None else ""
        return (f"Return to the docking station{where}.",)
    if starts and homes and starts[0].start < homes[0].start and 1 <= len(areas) <= 2:
        first, last = _area_of(areas[0]), _area_of(areas[-1])
        if first is None:
            return None
        end = last if last is not None else first
        return (f"Start in starting area {first}.", f"End of the mission: starting area {end}.")
    return None


_BOTH = 2
_NEAR = 5
"""characters between `end` and what ends, perhaps with an article"""


def _may_be_in_case(found: Mentions, homes: Sequence[Mention]) -> bool:
    """Return True if unknown words may say when the robot goes home, or what ends: `Siren: back to
    the dock`, `the shutdown ends tomorrow`, `end of list`."""
    first = min(home.start for home in homes)
    before = any(found.occasion <= word.start < first for word in found.unknown)
    behind = (word.start - home.end for home in homes for word in found.unknown)
    of_others = not found.has("place") and any(0 <= gap <= _NEAR for gap in behind)
    return (before and not found.has("last")) or of_others


def _order(found: Mentions, _: Known) -> Sentences | None:
    """`any order is fine`"""
    if found.has("ANY_ORDER", "ORDER_FREE") and found.only("ANY_ORDER", "ORDER_FREE"):
        return ("Order: any.",)
    allowed = ("THIS_ORDER", "MEASURE", "DO_FOLLOWING", "KIND", "STEP", "TIME_WORD", "ROUNDS_OF")
    if found.has("THIS_ORDER") and found.only(*allowed):
        return ("Order: precise.",)
    return None


def _wait(found: Mentions, _: Known) -> Sentences | None:
    lengths = found.of("DURATION")
    if len(lengths) == 1 and found.has("WAIT", "PAUSE") and found.only("WAIT", "PAUSE", "DURATION"):
        text = length_words(lengths[0].value)
        return None if text is None else (f"Wait for {text}.",)
    return None


def _before_unknown(mention: Mention, found: Mentions) -> bool:
    """Return True if an unknown word follows at once, as in `no ladder`."""
    return any(0 <= word.start - mention.end <= 1 for word in found.unknown)


def _words_between(found: Mentions, named: Sequence[Mention]) -> bool:
    """Return True if an unknown word stands between checkpoints: `R7 as long as R40 is open`."""
    first, last = named[0].end, named[-1].start
    return any(first <= word.start < last for word in found.unknown)


def _verb_before(found: Mentions, last: Mention) -> bool:
    """Return True if an unknown word stands where the verb of an order does: `paint valve R25`."""
    before = [w for w in found.unknown if found.occasion <= w.start and w.end <= last.start]
    return bool(before) and not found.has("MEASURE", "BE_MEASURED", "measuring")


def _area_of(mention: Mention) -> int | None:
    place = mention.value
    if isinstance(place, AreaLocation):
        return place.area
    if isinstance(place, DockLocation) and place.area is not None:
        return place.area.area
    return None


def length_words(value: object) -> str | None:
    """Return a time in words of the mission language; None if it is none that can be waited."""
    assert isinstance(value, Length)
    if value.other is not None or not 0 < value.seconds < _LONGEST_S:
        return None
    return seconds_words(value.seconds)


def seconds_words(seconds: float) -> str:
    """Return a time in words of the mission language."""
    minutes = seconds / 60
    if minutes != int(minutes):
        return f"{seconds:g} s"
    return f"{minutes:g} minutes" if minutes != 1 else "1 minute"


_FRAMES: tuple[Callable[[Mentions, Known], Sentences | None], ...] = (
    _replace,
    _leave_out,
    _duration,
    _in_the_same_area,
    _start_and_end,
    _order,
    _wait,
    _later,
    _between_after,
    _spaced,
    _go,
    _check,
    _floors,
)
