"""Tells what happens in a run."""

from collections.abc import Callable

from argo_compiler.base.model import Model
from argo_env.run.log import Entry
from argo_env.run.machine import Machine
from argo_env.run.observer import Observer
from argo_env.run.record import Reading
from argo_planner.service.runs.state import EntryTold

Tell = Callable[[Model], None]


class RunTeller(Observer):
    """Tells the entries of a run, with their numbers. Holds the last readings."""

    def __init__(self, run: str, tell: Tell, past: tuple[Entry, ...] = ()) -> None:
        self._run, self._tell = run, tell
        self.count = 0
        self.readings: dict[int, Reading] = {}
        self.fresh = True
        """whether something has been told since this was last set to False"""
        for entry in past:
            self._note(entry)

    def on_change(self, entry: Entry, machine: Machine) -> None:  # noqa: ARG002
        """An entry was made, and the machine has it."""
        self._note(entry)
        self._tell(EntryTold.model_construct(run=self._run, number=self.count, entry=entry))

    def _note(self, entry: Entry) -> None:
        self.count += 1
        self.fresh = True
        if entry.reading is not None:
            self.readings[entry.reading.checkpoint] = entry.reading
