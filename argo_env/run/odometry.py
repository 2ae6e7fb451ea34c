"""Sums along the robot's way: metres, contacts with the site, and mishaps. Touches that follow each
other closely are one contact, from first to last."""

import math
from collections.abc import Iterable, Sequence

from argo_env.drives.drive import Incident
from argo_env.robot.pose import BodyPose
from argo_env.run.log import Entry
from argo_env.run.record import DIGITS, Contact, Mishap
from argo_env.site import Site
from argo_env.world.world import Touch

CONTACT_GAP = 0.5  # s without a touch that end a contact; shorter, it is the same scrape


class ContactTracker:
    """Joins touches to contacts, one for each pair of parts. Holds those that may still go on."""

    def __init__(self) -> None:
        self._open: dict[tuple[str, str], Contact] = {}

    @property
    def open(self) -> tuple[Contact, ...]:
        """The contacts that may still go on."""
        return tuple(self._open.values())

    def restore(self, contacts: Iterable[Contact]) -> None:
        """Goes on from what `open` was."""
        self._open = {(c.link, c.element): c for c in contacts}

    def note(self, touches: Iterable[Touch], now: float) -> tuple[Contact, ...]:
        """Takes note of all touches at time `now` (s); returns the contacts that are over."""
        deepest: dict[tuple[str, str], Touch] = {}
        for touch in touches:
            key = (touch.link, touch.element)
            if key not in deepest or touch.depth > deepest[key].depth:
                deepest[key] = touch
        over = [k for k, c in self._open.items() if now - c.end > CONTACT_GAP]
        closed = tuple(self._open.pop(key) for key in over)
        for key, touch in deepest.items():
            known = self._open.get(key)
            depth = round(touch.depth, DIGITS)
            if known is None:
                x, y, z = (round(v, DIGITS) for v in touch.point)
                self._open[key] = Contact(
                    start=now, end=now, link=touch.link, element=touch.element,
                    x=x, y=y, z=z, depth=depth,
                )  # fmt: skip
            else:
                update = {"end": now, "depth": max(depth, known.depth)}
                self._open[key] = known.model_copy(update=update)
        return closed


class Odometry:
    """Adds up step by step. Holds the sums and the contacts that may still go on."""

    def __init__(self, site: Site) -> None:
        self.distance = 0.0
        """m, driven since the mission's start"""
        self.climbed = 0.0
        """m, upwards since the mission's start"""
        self.over: list[Contact] = []
        """contacts that are over and not yet told"""
        self.mishaps: list[Mishap] = []
        """those that are not yet told"""
        self._seen = 0  # of the drive's incidents
        self._site = site
        self._contacts = ContactTracker()

    @property
    def touching(self) -> tuple[Contact, ...]:
        """Contacts that may still go on."""
        return self._contacts.open

    def restore(self, entry: Entry) -> None:
        """Goes on from an entry."""
        self.distance, self.climbed = entry.distance, entry.climbed
        self._contacts.restore(entry.touching)

    def close(self) -> None:
        """No contact goes on any longer."""
        self.over += self._contacts.open
        self._contacts.restore(())

    def moved(
        self, before: BodyPose, after: BodyPose, touches: Iterable[Touch], now: float
    ) -> None:
        """The robot has gone from `before` to `after` until time `now` (s), touching these."""
        self.distance += math.dist((before.x, before.y, before.z), (after.x, after.y, after.z))
        self.climbed += max(0.0, after.z - before.z)
        self.over += self._contacts.note(touches, now)

    def trouble(self, incidents: Sequence[Incident], now: float) -> None:
        """Notes which of the drive's `incidents` are new at time `now` (s)."""
        for incident in incidents[self._seen :]:
            pose = incident.pose
            self.mishaps.append(
                Mishap(
                    t=now,
                    trouble=incident.trouble,
                    detail=incident.detail,
                    place=(round(pose.x, DIGITS), round(pose.y, DIGITS), round(pose.z, DIGITS)),
                    floor=self._site.floor_at(pose.z),
                )
            )
        self._seen = len(incidents)
