"""Patrols of floors, and through places."""

from argo_compiler.base.model import Pose
from argo_compiler.script.resolve import making
from argo_compiler.script.resolve.context import Context
from argo_compiler.script.resolve.limiting import make_round, timed
from argo_compiler.script.resolve.manners import Manners
from argo_compiler.script.resolve.program import Do, ProgramRound
from argo_compiler.script.syntax.tree import orders
from argo_compiler.script.syntax.tree.places import FloorName, PlaceLocation


def patrol_rounds(
    order: orders.Patrol, context: Context, manners: Manners
) -> tuple[list[ProgramRound], list[Do]]:
    """The rounds of a patrol: one for each floor, or one through the places; and their stops."""
    limited = timed(order, context.diagnostics)
    rounds: list[ProgramRound] = []
    tasks: list[Do] = []
    for base, poses in _places(order, context):
        round_ = make_round(limited, base, context, order.name)
        stops = [making.waypoint(pose, order.span) for pose in poses]
        manners.furnish(limited, stops)
        context.put(stops, round_.body, None)
        tasks += stops
        rounds.append(round_)
    return rounds, tasks


def _places(order: orders.Patrol, context: Context) -> list[tuple[str, list[Pose]]]:
    """What the rounds are called, and through which places they lead."""
    manner = order.manner
    floors = [p for p in order.places if isinstance(p, FloorName)]
    if len(floors) > 1 and manner is not None and manner.duration is not None:
        message = "this duration can be read as that of each floor or of all together"
        hint = "write one patrol for each floor, each with its own duration"
        context.diagnostics.refuse("ambiguous-duration", message, order.span, hint)
    rounds: list[tuple[str, list[Pose]]] = []
    through: list[Pose] = []
    label = ""
    for place in order.places:
        if isinstance(place, FloorName):
            floor = context.lookup.floor(place)
            rounds.append((f"Patrol floor {floor.number}", list(floor.patrol)))
            continue
        pose, area = context.locator.locate(place, "end")
        if isinstance(place, PlaceLocation):
            label = label or place.name.removeprefix("the ")
        label = label or (f"area {area.number}" if area else "place")
        through.append(pose)
    if through:
        rounds.append((f"Patrol {label}", through))
    if order.name is not None and len(rounds) > 1:
        message = "this name stands before a command with several rounds"
        hint = "give each of them a line and a name"
        context.diagnostics.error("one-name", message, order.span, hint)
    return rounds
