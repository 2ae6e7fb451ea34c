"""Fakes: a remote robot, the link to it, and the clock of both ends."""

from collections import Counter

from argo_env.remote.channel import Channel
from argo_env.remote.messages import ORDERS, CancelOrder, EndReport, RobotState, StartOrder


class Wires:
    """A link between two ends: texts get lost or arrive twice, and none arrive while `broken`."""

    def __init__(self, random, loss=0.0):
        self._random, self._loss = random, loss
        self.broken = False
        self._boxes = ([], [])

    def end(self, side):
        return WiresEnd(self, side)

    def carry(self, side, text):
        if self.broken or self._random.random() < self._loss:
            return
        times = 2 if self._random.random() < self._loss else 1
        self._boxes[1 - side].extend([text] * times)

    def collect(self, side):
        texts, self._boxes[side][:] = list(self._boxes[side]), []
        if self._loss:
            self._random.shuffle(texts)
        return texts


class WiresEnd:
    def __init__(self, wires, side):
        self._wires, self._side = wires, side

    def send(self, text):
        self._wires.carry(self._side, text)

    def receive(self):
        return self._wires.collect(self._side)


class Time:
    """A clock that moves only while a caller sleeps; then each of the `others` makes a step."""

    def __init__(self):
        self.now = 1_000_000.0
        self.others = []

    def __call__(self):
        return self.now

    def sleep(self, seconds):
        self.now += seconds
        for other in self.others:
            other.live()


class FakeRobot:
    """A robot that takes `TICKS` steps for each action, and then is at the task's pose."""

    TICKS = 12

    def __init__(self, wires, time, values=None):
        self._wires, self._time = wires, time
        self._values = values or {}
        self._session = 0
        self.ended = {}
        """reports of ends by action id, as if stored on the robot's disk"""
        self.begun = Counter()
        self.finished = Counter()
        self.stopped = []
        self.pose = None
        self.doing = None
        self.dead = False
        self.boot()

    def boot(self, forget=False):
        """Start the robot's process, or restart it; `forget` also clears its disk."""
        self._session += 1
        self._channel = Channel(self._wires.end(1), f"robot {self._session}", self._time)
        self.doing, self.dead = None, False
        if forget:
            self.ended = {}

    def live(self):
        if self.dead:
            return
        for body in self._channel.receive():
            match ORDERS.validate_python(body):
                case StartOrder() as order:
                    self._start(order)
                case CancelOrder(id=id) if self.doing and self.doing[0].id == id:
                    self.stopped.append(id)
                    self._end(EndReport(id=id, outcome="stopped"))
        if self.doing:
            order, left = self.doing
            self.doing = (order, left - 1)
            if left == 0:
                self._finish(order)
        known = (*self.ended, *((self.doing[0].id,) if self.doing else ()))
        action = self.doing[0].id if self.doing else None
        self._channel.send_once(RobotState(pose=self.pose, charge=0.5, action=action, known=known))
        self._channel.flush()

    def _start(self, order):
        if order.id in self.ended:
            self._channel.post(self.ended[order.id])
        elif self.doing is None or self.doing[0].id != order.id:
            self.begun[order.id] += 1
            self.doing = (order, self.TICKS)

    def _finish(self, order):
        task = order.task
        if task.pose is not None:
            self.pose = task.pose
        value = self._values.get(task.object_id, 3.0) if task.action == "MEASURE" else None
        self.finished[order.id] += 1
        self._end(EndReport(id=order.id, outcome="done", value=value))

    def _end(self, report):
        self.ended[report.id] = report
        self.doing = None
        self._channel.post(report)
