"""Random protocols, and an interpreter of their sentences that knows neither tasks nor groups."""

import random
import zlib
from collections import Counter
from contextlib import suppress
from dataclasses import dataclass, field

HORIZON = 400.0
"""s of a mission that are looked at"""


# ---- what protocols say


@dataclass
class Test:
    """Bounds for values, joined by `and` or by `or`."""

    parts: list[tuple[int, str, int]]
    joint: str = "and"

    def said(self):
        return f" {self.joint} ".join(f"#{n} is {word} {bound}" for n, word, bound in self.parts)


@dataclass
class Case:
    """`If ..., A and B; otherwise C`; what is done otherwise is orders, or a case by itself."""

    test: Test
    orders: list
    unless: bool = False
    other: "list | Case | None" = None

    def said(self):
        text = f"{'unless' if self.unless else 'if'} {self.test.said()}, {say(self.orders)}"
        if isinstance(self.other, Case):
            return f"{text}; otherwise, {self.other.said()}"
        return text if self.other is None else f"{text}; otherwise {say(self.other)}"


@dataclass
class Step:
    """An order, and what is said behind it."""

    number: int
    head: tuple
    failed: list | None = None
    cases: list[Case] = field(default_factory=list)
    then: int | None = None
    """the step to go to in any case"""

    def said(self):
        sentences = [say([self.head])]
        if self.failed is not None:
            sentences.append(f"if it fails, {say(self.failed)}")
        sentences += [case.said() for case in self.cases]
        if self.then is not None:
            sentences.append(f"then go to step {self.then}")
        return ". ".join(s[0].upper() + s[1:] for s in sentences)


@dataclass
class Rounds:
    """Steps that are repeated, and what is done after the last round."""

    first: int
    last: int
    count: int = 0
    until: Test | None = None
    every: int = 0
    duration: int = 0
    """s; the round is finished"""
    after: Case | None = None
    inside: list["Rounds"] = field(default_factory=list)

    def said(self):
        text = f"Repeat steps {self.first} to {self.last}"
        if self.until is not None:
            text += f" until {self.until.said()}, at most {self.count} times in total"
        elif self.duration:
            text += f" for {self.duration} s, finishing the round"
        else:
            text += f" {self.count} times in total"
        text += f", every {self.every} s" if self.every else ""
        after = "" if self.after is None else f". {self.after.said().capitalize()}"
        return f"{text}{after}"


def say(orders):
    """Orders in words."""
    return " and ".join(_SAID[kind](*rest) for kind, *rest in orders)


_SAID = {
    "check": lambda n: f"check #{n}",
    "retried": lambda n: f"check #{n}, retry once",
    "patrol": lambda n: f"patrol floor {n} twice",
    "wait": lambda s: f"wait {s} s",
    "wait until": lambda n, s: f"wait at most {s} s until #{n} is above 5",
    "check if": lambda n, m: f"check #{n} if #{m} is above 5",
    "check unless": lambda n, m: f"check #{n} unless #{m} is above 5",
    "times": lambda n, k: f"check #{n} {k} times",
    "until": lambda n, k: f"check #{n} until it is above 5, at most {k} times",
    "go": lambda step: f"go to step {step}",
    "home": lambda: "return to the docking station",
    "end": lambda: "end the mission",
    "on": lambda: "go on",
}


def script(steps, rounds):
    """The protocol; each repetition stands behind the last step that it repeats."""
    lines = ["Mission Protocol", "Start area: 1"]
    for step in steps:
        lines.append(f"{step.number}. {step.said()}.")
        ending = [r for r in flat(rounds) if r.last == step.number]
        lines += [f"{r.said()}." for r in sorted(ending, key=lambda r: -r.first)]
    return "\n".join(lines)


def flat(rounds):
    return [r for top in rounds for r in (top, *flat(top.inside))]


# ---- what comes of them


def value(number, visit):
    """What is read at a visit of a checkpoint; None: it fails."""
    found = zlib.crc32(f"{number} {visit}".encode()) % 13
    return None if found > 10 else float(found)


class Ended(Exception):
    """The mission is over."""


class Led(Exception):
    """A branch leads to a step."""

    def __init__(self, step):
        self.step = step


class WentOn(Exception):
    """A condition says to go on: those behind it are not looked at."""


class Interpreter:
    """Carries the sentences out. Mutable."""

    def __init__(self, steps, rounds):
        self.steps = {step.number: step for step in steps}
        self.whole = Rounds(1, len(steps), 1, inside=rounds)
        self.visits = Counter()
        self.values = {}
        self.now = 0.0
        self.done = []

    def run(self):
        with suppress(Ended):
            self.all_rounds(self.whole, 1)
        return self.done

    def do(self, what, seconds=1.0):
        if self.now > HORIZON:
            raise Ended
        if what is not None:
            self.done.append((self.now, what))
        self.now += seconds

    def check(self, number):
        self.do(number)
        self.visits[number] += 1
        self.values[number] = value(number, self.visits[number])

    def holds(self, test):
        found = []
        for number, word, bound in test.parts:
            value = self.values.get(number)
            if value is None:
                found.append(False)
            else:
                found.append(value > bound if word == "above" else value < bound)
        return all(found) if test.joint == "and" else any(found)

    # ---- rounds

    def round(self, r, at):
        """One round from a step on."""
        while at <= r.last:
            inner = next((i for i in r.inside if i.first <= at <= i.last), None)
            try:
                if inner is None:
                    self.step(self.steps[at])
                    at += 1
                else:
                    self.all_rounds(inner, at)
                    at = inner.last + 1
                    self.behind(inner, r)
            except Led as led:
                if not r.first <= led.step <= r.last:
                    raise
                at = led.step

    def all_rounds(self, r, at):
        began, done = self.now, 0
        while True:
            self.round(r, at if done == 0 else r.first)
            done += 1
            due = max(self.now, began + done * r.every)
            if r.count and done >= r.count:
                return
            if r.duration and due - began >= r.duration:
                return
            if r.until is not None and self.holds(r.until):
                return
            self.now = due

    def behind(self, inner, outer):
        """What comes after the last round."""
        if inner.after is not None:
            with suppress(WentOn):
                self.case(inner.after)
        step = self.steps[inner.last]
        if step.then is not None and (outer.last != inner.last or outer is self.whole):
            raise Led(step.then)

    # ---- steps

    def step(self, step):
        failed = self.order(step.head)
        if failed and step.failed is not None:
            with suppress(WentOn):
                self.orders(step.failed)
        with suppress(WentOn):
            for case in step.cases:
                self.case(case)
        ends = any(r.last == step.number for r in flat(self.whole.inside))
        if step.then is not None and not ends:
            raise Led(step.then)

    def case(self, case):
        if self.holds(case.test) is not case.unless:
            self.orders(case.orders)
        elif isinstance(case.other, Case):
            self.case(case.other)
        elif case.other is not None:
            self.orders(case.other)

    def orders(self, orders):
        for order in orders:
            self.order(order)

    def order(self, order):
        """Does it; whether it failed."""
        kind, *rest = order
        match kind:
            case "check":
                self.check(*rest)
                return self.values[rest[0]] is None
            case "retried":
                self.check(*rest)
                if self.values[rest[0]] is None:
                    self.check(*rest)
                return self.values[rest[0]] is None
            case "patrol":
                for _ in range(8):
                    self.do("drive")
            case "wait":
                self.do(None, rest[0])
            case "wait until":
                if not self.holds(Test([(rest[0], "above", 5)])):
                    self.do(None, rest[1])
            case "check if" | "check unless":
                if self.holds(Test([(rest[1], "above", 5)])) is (kind == "check if"):
                    self.check(rest[0])
            case "times" | "until":
                for _ in range(rest[1]):
                    self.check(rest[0])
                    if kind == "until" and self.holds(Test([(rest[0], "above", 5)])):
                        break
            case "go":
                raise Led(rest[0])
            case "home":
                self.do("home")
                raise Ended
            case "end":
                raise Ended
            case "on":
                raise WentOn
        return False


# ---- random protocols


class Writer:
    """Makes up protocols. Mutable."""

    def __init__(self, seed):
        self.rng = random.Random(seed)
        self.extra = iter(range(7, 21))
        self.n = self.rng.randint(1, 6)

    def protocol(self):
        steps = [self.step(number) for number in range(1, self.n + 1)]
        return steps, self.rounds(steps)

    def step(self, number):
        rng = self.rng
        head = rng.choice(
            [("check", number)] * 5
            + [("retried", number), ("patrol", number), ("wait", rng.randint(1, 9))]
            + [("times", number, rng.randint(2, 3)), ("until", number, 3)]
        )
        step = Step(number, head)
        if head[0] in ("check", "retried") and rng.random() < 0.25:
            step.failed = self.branch()
        for k in range(rng.choice([0, 0, 1, 1, 2])):
            step.cases.append(self.case(number, other=k == 0))
        if rng.random() < 0.1:
            step.then = rng.randint(1, self.n)
        return step

    def test(self, last):
        rng = self.rng
        parts = []
        for _ in range(rng.choice([1, 1, 1, 2])):
            number = rng.randint(max(1, last - 2), last)
            parts.append((number, *rng.choice([("above", 5), ("below", 4), ("above", 3)])))
        if len(parts) == 2 and parts[0][0] == parts[1][0]:
            parts.pop()
        return Test(parts, rng.choice(["and", "or"]))

    def case(self, last, other):
        rng = self.rng
        found = Case(self.test(last), self.branch(), rng.random() < 0.2)
        open_ = found.orders[-1][0] in ("check if", "check unless")
        if other and not open_ and rng.random() < 0.4:
            chained = rng.random() < 0.3 and not found.unless
            found.other = self.case(last, other) if chained else self.branch()
            if isinstance(found.other, Case):
                found.other.unless = False
        return found

    def branch(self):
        rng = self.rng
        orders = []
        for _ in range(rng.choice([0, 1, 1, 2])):
            number = next(self.extra, None)
            if number is None:
                break
            orders.append(
                rng.choice(
                    [("check", number)] * 4
                    + [("wait", rng.randint(1, 9)), ("wait until", 1, 4)]
                    + [("check if", number, 1), ("check unless", number, 1)]
                    + [("times", number, 2), ("until", number, 3)]
                )
            )
        leave = rng.choice(
            [None] * 5 + [("go", rng.randint(1, self.n))] * 2 + [("home",), ("end",)]
        )
        if leave is not None or not orders:
            orders.append(leave or ("on",))
        return orders

    def rounds(self, steps):
        rng = self.rng
        kept = []
        for _ in range(rng.randint(0, 3)):
            first, last = sorted(rng.randint(1, len(steps)) for _ in range(2))
            apart = not any(f < first <= e < last or first < f <= last < e for f, e in kept)
            if apart and (first, last) not in kept:
                kept.append((first, last))
        top, around = [], []
        for first, last in sorted(kept, key=lambda r: (r[0], -r[1])):
            while around and around[-1].last < first:
                around.pop()
            r = self.limited(Rounds(first, last, rng.randint(1, 3)))
            # What follows two rounds that end together, or a `then`, is not told apart here.
            alone = not any(e == last and f != first for f, e in kept)
            if alone and steps[last - 1].then is None and rng.random() < 0.4:
                r.after = self.case(last, other=True)
            (around[-1].inside if around else top).append(r)
            around.append(r)
        return top

    def limited(self, r):
        rng = self.rng
        kind = rng.choice(["count"] * 4 + ["until", "duration"])
        if kind == "until":
            r.until = Test([(rng.randint(r.first, r.last), "above", 5)])
        elif kind == "duration":
            r.count, r.duration = 0, rng.randint(5, 40)
        if rng.random() < 0.2:
            r.every = rng.randint(5, 30)
        return r
