"""Odometry of a run: distance, climb, contacts with the site, and mishaps of the drive.

Touches that follow each other closely are one contact, from the first touch to the last. A contact
is open, and may still go on, until no touch has followed for CONTACT_GAP.
"""

import math
from collections.abc import Iterable, Sequence

from argo_compiler.base.wording import wording_of
from argo_env.drives.drive import Incident
from argo_env.robot.pose import BodyPose
from argo_env.run.log import Entry
from argo_env.run.record import DIGITS, Contact, Mishap
from argo_env.site import Site
from argo_env.world.world import Touch

CONTACT_GAP = 0.5  # s without a touch that end a contact; after a shorter gap it continues


class ContactTracker:
    """Tracker that joins touches to contacts, one for each pair of robot link and site element.

    It holds the open contacts.
    """

    def __init__(self) -> None:
        self._open: dict[tuple[str, str], Contact] = {}

    @property
    def open(self) -> tuple[Contact, ...]:
        """Contacts whose last touch is so recent that a further one would continue them."""
        return tuple(self._open.values())

    def restore(self, contacts: Iterable[Contact]) -> None:
        """Replace the open contacts, for a run that is resumed."""
        self._open = {(c.link, c.element): c for c in contacts}

    def add_touches_and_pop_ended(
        self, touches: Iterable[Touch], now: float
    ) -> tuple[Contact, ...]:
        """Add all touches at time `now` (s); remove and return the contacts ended by then."""
        deepest: dict[tuple[str, str], Touch] = {}
        for touch in touches:
            key = (touch.link, touch.element)
            if key not in deepest or touch.depth > deepest[key].depth:
                deepest[key] = touch
        ended_keys = [k for k, c in self._open.items() if now - c.end > CONTACT_GAP]
        ended = tuple(self._open.pop(key) for key in ended_keys)
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
        return ended


class Odometry:
    """Sums of the robot's motion, which grow with each step, and its contacts and mishaps."""

    def __init__(self, site: Site) -> None:
        self.distance = 0.0
        """m, driven since the mission's start"""
        self.climbed = 0.0
        """m, upwards since the mission's start"""
        self.ended_contacts: list[Contact] = []
        """ended contacts that are in no entry yet"""
        self.mishaps: list[Mishap] = []
        """mishaps that are in no entry yet"""
        self._incident_count = 0  # incidents of the drive that were added already
        self._site = site
        self._contacts = ContactTracker()

    @property
    def touching(self) -> tuple[Contact, ...]:
        """Open contacts, as `ContactTracker.open`."""
        return self._contacts.open

    def restore(self, entry: Entry) -> None:
        """Restore the sums and the open contacts from an entry of the log."""
        self.distance, self.climbed = entry.distance, entry.climbed
        self._contacts.restore(entry.touching)

    def close_contacts(self) -> None:
        """Move all open contacts to `ended_contacts`, as the run ends."""
        self.ended_contacts += self._contacts.open
        self._contacts.restore(())

    def add_motion(
        self, before: BodyPose, after: BodyPose, touches: Iterable[Touch], now: float
    ) -> None:
        """Add a motion from `before` to `after`, up to time `now` (s), with its touches."""
        self.distance += math.dist((before.x, before.y, before.z), (after.x, after.y, after.z))
        self.climbed += max(0.0, after.z - before.z)
        self.ended_contacts += self._contacts.add_touches_and_pop_ended(touches, now)

    def add_new_incidents(self, all_incidents: Sequence[Incident], now: float) -> None:
        """Add the incidents of the drive that are new since the last call as mishaps at `now` (s).

        `all_incidents` are all since the robot was placed for this run, also earlier ones.
        """
        for incident in all_incidents[self._incident_count :]:
            pose = incident.pose
            self.mishaps.append(
                Mishap(
                    t=now,
                    trouble=incident.trouble,
                    detail=incident.detail,
                    detail_wording=wording_of(incident.detail),
                    place=(round(pose.x, DIGITS), round(pose.y, DIGITS), round(pose.z, DIGITS)),
                    floor=self._site.floor_at(pose.z),
                )
            )
        self._incident_count = len(all_incidents)
