"""Generators of inputs from a corpus."""

import copy
import json
import random
import re
from collections.abc import Sequence
from functools import cached_property


class Mutator:
    """Generator of inputs from a corpus, whose pieces it cuts, doubles, inserts and replaces."""

    def __init__(self, corpus: Sequence[bytes]) -> None:
        self.rng = random.Random()
        self.corpus = corpus
        self.words = sorted({word for text in corpus for word in re.findall(rb"\w+|\W", text)})

    def make(self) -> bytes:
        return self.mutate(self.rng.choice(self.corpus), (1, 1, 1, 1, 2, 3, 5, 10, 40))

    def mutate(self, text: bytes, times: Sequence[int]) -> bytes:
        pieces = re.findall(rb"\w+|\W", text)
        for _ in range(self.rng.choice(times)):
            pieces = self.rng.choice(self.STEPS)(self, pieces)
        return b"".join(pieces)

    def _at(self, pieces: list[bytes]) -> int:
        return self.rng.randrange(len(pieces) + 1)

    def _cut(self, pieces: list[bytes]) -> list[bytes]:
        at = self._at(pieces)
        return pieces[:at] + pieces[at + self.rng.choice((1, 1, 2, 8, 60)) :]

    def _insert(self, pieces: list[bytes]) -> list[bytes]:
        at = self._at(pieces)
        return [*pieces[:at], self.rng.choice(self.words), *pieces[at:]]

    def _replace(self, pieces: list[bytes]) -> list[bytes]:
        at = self._at(pieces)
        return [*pieces[:at], self.rng.choice(self.words), *pieces[at + 1 :]]

    def _double(self, pieces: list[bytes]) -> list[bytes]:
        at = self._at(pieces)
        piece = pieces[at : at + self.rng.choice((1, 5, 30, 200))]
        return pieces[:at] + piece * self.rng.choice((2, 2, 3, 20)) + pieces[at:]

    def _splice(self, pieces: list[bytes]) -> list[bytes]:
        other = re.findall(rb"\w+|\W", self.rng.choice(self.corpus))
        at, start = self._at(pieces), self._at(other)
        length = self.rng.choice((3, 20, 100))
        return pieces[:at] + other[start : start + length] + pieces[at:]

    def _number(self, pieces: list[bytes]) -> list[bytes]:
        numbers = [i for i, piece in enumerate(pieces) if piece.isdigit()]
        if not numbers:
            return pieces
        at = self.rng.choice(numbers)
        number = self.rng.choice((b"0", b"1", b"-1", b"99999999999", b"1e999", b"0.5", b"nan"))
        return [*pieces[:at], number, *pieces[at + 1 :]]

    def _byte(self, pieces: list[bytes]) -> list[bytes]:
        at = self._at(pieces)
        return [*pieces[:at], bytes([self.rng.randrange(256)]), *pieces[at:]]

    def _letter(self, pieces: list[bytes]) -> list[bytes]:
        at = self.rng.randrange(len(pieces)) if pieces else 0
        word = pieces[at] if pieces else b""
        if len(word) < 2:
            return pieces
        i = self.rng.randrange(len(word))
        slip = self.rng.choice((word[:i] + word[i + 1 :], word[:i] + word[i : i + 1] + word[i:]))
        return [*pieces[:at], slip, *pieces[at + 1 :]]

    STEPS = (_cut, _insert, _replace, _double, _splice, _number, _byte, _letter)


class Composer(Mutator):
    """Generator of scripts of a few lines from anywhere in a corpus, with few changes."""

    HEADER = b"Mission Protocol #1\n1. Set a starting point in starting area 1\n2. Check #1\n"

    def make(self) -> bytes:
        lines = self.rng.choices(self.lines, k=self.rng.choice((1, 2, 3, 6)))
        return self.mutate(self.HEADER + b"\n".join(lines), (0, 0, 0, 1, 1, 2, 5))

    @cached_property
    def lines(self) -> list[bytes]:
        return [line for text in self.corpus for line in text.splitlines() if line.strip()]


class Restructurer:
    """Generator of mission files that stay valid JSON; it swaps, doubles and removes values."""

    ODD_VALUES = (None, True, 0, -1, 1, 0.5, 1e300, 10**30, "", "A", "A/B", "1", [], {}, "MEASURE")

    def __init__(self, corpus: Sequence[bytes]) -> None:
        self.rng = random.Random()
        self.missions = [json.loads(text) for text in corpus]

    def make(self) -> bytes:
        mission = copy.deepcopy(self.rng.choice(self.missions))
        for _ in range(self.rng.choice((1, 1, 1, 2, 3, 8, 30))):
            if mission:
                self._change(*self._draw_value(mission))
        return json.dumps(mission).encode()

    def _draw_value(self, data: object) -> tuple[dict[str, object] | list[object], str | int]:
        """Draw a value somewhere in the data, and return its container and its key."""
        while True:
            key = self.rng.choice(list(data) if isinstance(data, dict) else range(len(data)))
            part = data[key]
            if not part or not isinstance(part, dict | list) or self.rng.random() < 0.2:
                return data, key
            data = part

    def _change(self, holder: dict[str, object] | list[object], key: str | int) -> None:
        choice = self.rng.random()
        if choice < 0.2:
            del holder[key]
        elif choice < 0.5 and isinstance(key, int):
            holder.insert(self.rng.randrange(len(holder) + 1), copy.deepcopy(holder[key]))
        elif choice < 0.6:
            holder[key] = self.rng.choice(self.ODD_VALUES)
        elif choice < 0.8 and isinstance(holder[key], int | float):
            holder[key] = self.rng.choice((holder[key] + 1, holder[key] * 2, -holder[key]))
        else:
            other, at = self._draw_value(self.rng.choice(self.missions))
            holder[key] = copy.deepcopy(other[at])
