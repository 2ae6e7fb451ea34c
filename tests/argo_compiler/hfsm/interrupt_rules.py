"""Interruptions of a mission by rules R1 to R10, I1, I2 and M9, without a table."""

from dataclasses import dataclass, replace

from argo_compiler.il import Afterwards, Response


@dataclass(frozen=True)
class Alarmed:
    """Control of the robot by mission, reaction or person, in the terms of the rules."""

    paused: bool = False
    alarms: tuple = ()
    """(event, whether its `until` has occurred), in the order in which the events occurred"""
    at: object = None
    """the event of the active alarm"""
    there: bool = False
    """whether its drive is over"""
    outcome: str | None = None

    @property
    def moves(self):
        """The owner of the action that may run: "mission", an event, or None."""
        if self.outcome or self.paused or self.there:
            return None
        return "mission" if self.at is None else self.at


class Rules:
    """Rules for one set of reactions."""

    def __init__(self, reactions):
        self.reactions = {reaction.event: reaction for reaction in reactions}

    def occurs(self, s, event):
        if s.outcome:
            return s
        own = self.reactions.get(event)
        if own and own.response is Response.ABORT:
            return Alarmed(outcome="aborted")
        known = [e for e, _ in s.alarms]
        alarms = tuple(
            (e, True if self.reactions[e].until is event else over and e is not event)
            for e, over in s.alarms
        )
        s = replace(s, alarms=alarms)
        if own and own.response is not Response.REPORT and event not in known:
            active = self.reactions.get(s.at)
            only_ends_the_hold = (
                active and active.until is event and own.urgency_score <= active.urgency_score
            )
            if not only_ends_the_hold:
                s = replace(s, alarms=(*alarms, (event, False)))
        return self.arranged(s)

    def pauses(self, s):
        return s if s.outcome else replace(s, paused=True)

    def resumes(self, s):
        if s.outcome:
            return s
        if s.paused:
            return self.arranged(replace(s, paused=False))
        return self.released(s) if s.there else s

    def cancels(self, s):
        return s if s.outcome else Alarmed(outcome="cancelled")

    def drive_succeeds(self, s):
        if s.outcome or s.at is None or s.there:
            return s
        return self.arrived(s)

    def drive_fails(self, s):
        if s.outcome or s.at is None or s.there:
            return s
        if self.reactions[s.at].afterwards is Afterwards.END:
            return Alarmed(outcome="failed")
        return replace(self.without(s), paused=True)

    def limit_is_over(self, s):
        if s.outcome or s.paused or not s.there:
            return s
        reaction = self.reactions[s.at]
        if reaction.on_limit is Afterwards.RESUME:
            return self.released(s)
        if reaction.on_limit is Afterwards.WAIT:
            return replace(self.without(s), paused=True)
        return Alarmed(outcome=self.place(reaction))

    def plan_ends(self, s, outcome, whenever):
        if s.outcome or not (whenever or s.moves == "mission"):
            return s
        return Alarmed(outcome=outcome)

    # Parts

    def arranged(self, s):
        """Return the state after a change: the highest rank is active, and a hold may be over."""
        if s.paused or not s.alarms:
            return s
        top = max(s.alarms, key=lambda alarm: self.reactions[alarm[0]].urgency_score)[0]
        active = self.reactions.get(s.at)
        if active is None or self.reactions[top].urgency_score > active.urgency_score:
            s = replace(s, at=top, there=False)
            return self.arrived(s) if self.reactions[top].response is Response.PAUSE else s
        return self.released(s) if s.there and dict(s.alarms)[s.at] else s

    def arrived(self, s):
        reaction = self.reactions[s.at]
        stays = reaction.response is Response.PAUSE or reaction.until is not None
        if stays and not dict(s.alarms)[s.at]:
            return replace(s, there=True)
        return self.released(s)

    def released(self, s):
        reaction = self.reactions[s.at]
        s = self.without(s)
        if reaction.response is Response.PAUSE or reaction.afterwards is Afterwards.RESUME:
            return self.arranged(s)
        if reaction.afterwards is Afterwards.WAIT:
            return replace(s, paused=True)
        return Alarmed(outcome=self.place(reaction))

    def without(self, s):
        alarms = tuple(alarm for alarm in s.alarms if alarm[0] is not s.at)
        return replace(s, alarms=alarms, at=None, there=False)

    def place(self, reaction):
        places = {Response.RETURN: "returned", Response.SAFE_AREA: "sheltered"}
        return places.get(reaction.response, "aborted")
