"""Contacts: touches that follow each other closely are one contact, from first to last."""

from collections.abc import Iterable

from argo_env.run.record import DIGITS, Contact
from argo_env.world.world import Touch

CONTACT_GAP = 0.5  # s without a touch that end a contact; shorter, it is the same scrape


class ContactWatch:
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
