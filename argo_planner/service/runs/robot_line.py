"""The line to a robot that is somewhere else."""

from argo_planner.service.rooms.mailbox import Mailbox, MailboxClosed


class RobotLine:
    """The connection of the robot, if there is one. Holds the texts that wait for it."""

    def __init__(self) -> None:
        self._mailbox: Mailbox | None = None

    def connect(self) -> Mailbox:
        """A robot has connected: the texts for it. One that was connected before is let go."""
        self.close("the robot has connected again")
        self._mailbox = Mailbox()
        return self._mailbox

    def is_that_of(self, mailbox: Mailbox) -> bool:
        """Whether it is still the connection that came with these texts."""
        return mailbox is self._mailbox

    def post(self, text: str) -> None:
        """A text for the robot, which nobody hears while it is not connected."""
        if self._mailbox is not None:
            self._mailbox.post(text)

    def disconnect(self, mailbox: Mailbox) -> None:
        """A connection has ended."""
        if mailbox is self._mailbox:
            self._mailbox = None

    def close(self, why: str) -> None:
        """Lets the robot go."""
        if self._mailbox is not None:
            self._mailbox.close(MailboxClosed(why))
