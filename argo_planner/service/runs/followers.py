"""Those who follow the robot's runs, and what waits to be sent to them."""

from collections.abc import Iterable

from argo_planner.service.rooms.mailbox import Mailbox, MailboxClosed


class RunFollowers:
    """Who follows, by client. Holds their mailboxes."""

    def __init__(self) -> None:
        self._mailboxes: dict[str, Mailbox] = {}

    def add(self, client: str, past: Iterable[str]) -> Mailbox:
        """Somebody follows from now on, and is told the past first."""
        self._mailboxes[client] = mailbox = Mailbox(past)
        return mailbox

    def remove(self, client: str) -> None:
        """Somebody has gone."""
        self._mailboxes.pop(client, None)

    def post(self, *texts: str) -> None:
        """Texts that have to arrive, in this order."""
        for mailbox in self._mailboxes.values():
            for text in texts:
                mailbox.post(text)

    def post_newest(self, kind: str, text: str) -> None:
        """A text that takes the place of the one of its kind that still waits."""
        for mailbox in self._mailboxes.values():
            mailbox.post_newest(kind, text)

    def close(self, why: str) -> None:
        """Lets all of them go."""
        for mailbox in self._mailboxes.values():
            mailbox.close(MailboxClosed(why))
