"""Exported state chart in python-statemachine, driven by the rules of `docs/export.md`."""

import re
import xml.etree.ElementTree as ET

from statemachine.io import load

NS = {"s": "http://www.w3.org/2005/07/scxml"}
TASK, GROUP = re.compile(r"t\d+"), re.compile(r"g\d+")
ARGO = "{urn:argo:mission}"
KINDS = {1: "value", 2: "unreadable", 3: "unreachable", 4: "failed"}
GOING, ENDING = 0, 3


class Chart:
    """State chart in its engine; the test reads its state from its own data."""

    def __init__(self, text):
        # A class that python-statemachine loads can be started only once.
        self.load = lambda: load(text, format="scxml")()
        root = ET.fromstring(text)
        self.states = {e.get("id"): e for e in root.iter() if e.get("id")}
        self.max_duration = root.get(f"{ARGO}max_duration")
        self.names = {i: e.get(f"{ARGO}name") for i, e in self.states.items()}
        self.objects = {
            e.get(f"{ARGO}object_id"): e.get("id").removeprefix("known_")
            for e in root.iter(f"{{{NS['s']}}}data")
            if e.get(f"{ARGO}object_id") is not None
        }
        self.timed = [
            i
            for i, e in self.states.items()
            if e.find(f"s:transition[@event='timeout.{i}']", NS) is not None
        ]

    def start(self):
        self.chart = self.load()
        self.data = self.chart.model
        self.time_up = None if self.max_duration is None else float(self.max_duration)
        self.handle("tick", 0)

    def handle(self, event, now, **data):
        starts = self.data.starts
        while (due := self.due()) is not None and due[0] < now:
            self.send(due[2], due[0])
        self.send(event, now, **data)
        while True:
            if (due := self.due()) is not None and due[0] <= now:
                self.send(due[2], due[0])
            elif not self.finished and self.stopping and self.data.starts > starts:
                # The driver never saw an action that started and was cancelled at this moment.
                self.send("action.stopped", now)
            else:
                return

    def send(self, event, now, **data):
        if event == "event.time_up":
            self.time_up = None
        if not self.finished:
            self.chart.send(event, time=now, **data)
            assert "error" not in str(self.active)

    @property
    def active(self):
        return [s.id for s in self.chart.configuration]

    def due(self):
        """Return the next time-out: its due time, its rank among those due then, and its event."""
        data = self.data
        if self.finished or data.mode == ENDING:
            return None
        due = [] if self.time_up is None else [(self.time_up, 1, "event.time_up")]
        if data.mode == GOING:
            active = set(self.active)
            for order, group in enumerate(self.timed):
                if group in active:
                    until = getattr(data, f"until_{group[1:]}")
                    counts = self.states[group].get(f"{ARGO}clock") == "now"
                    at = until if counts else until + data.lost
                    due.append((at, 2 + order / 1000, f"timeout.{group}"))
            for order, kind in ((0, "wait"), (3, "window"), (4, "action"), (5, "limit")):
                due.append((getattr(data, f"due_{kind}"), order, f"timeout.{kind}"))
            if data.awaits:
                due.append((data.due_round, 7, "timeout.round"))
        elif not data.paused:
            due.append((data.due_hold, 6, "timeout.hold"))
        due = [(max(at, data.now), order, event) for at, order, event in due if at]
        return min(due, default=None)

    @property
    def deadline(self):
        due = self.due()
        return None if due is None else due[0]

    @property
    def finished(self):
        return self.chart.is_terminated

    @property
    def running(self):
        data = self.data
        return self.names[data.running_place] if data.running and not self.finished else None

    @property
    def stopping(self):
        return "stopping" in self.active

    def readings(self):
        return {
            object_id: (
                KINDS[getattr(self.data, f"known_{k}")],
                getattr(self.data, f"value_{k}") if getattr(self.data, f"known_{k}") == 1 else None,
                getattr(self.data, f"time_{k}"),
                getattr(self.data, f"abnormal_{k}") == 1,
            )
            for object_id, k in self.objects.items()
            if getattr(self.data, f"known_{k}")
        }

    def observation(self):
        """Return the task, the action, whether that is stopping, the rounds, and the outcome."""
        active = self.active
        if self.finished:
            return None, None, False, {}, active[0].replace("_", " ")
        if self.data.mode == ENDING:
            return None, self.running, self.stopping, {}, None
        tasks = [self.names[i] for i in active if TASK.fullmatch(i)]
        rounds = {
            self.names[i]: getattr(self.data, f"round_{i[1:]}")
            for i in active
            if GROUP.fullmatch(i)
        }
        return tasks[0] if tasks else None, self.running, self.stopping, rounds, None
