"""Generator of binary files from a corpus."""

import random
from collections.abc import Sequence


class BinaryMutator:
    """Generator of files from a corpus, whose bytes it changes, cuts, doubles and splices."""

    NUMBERS = (0, 1, 0x7F, 0xFF, 0x7FFF_FFFF, 0xFFFF_FFFF, 0x7FFF_FFFF_FFFF_FFFF, (1 << 64) - 1)

    def __init__(self, corpus: Sequence[bytes], rng: random.Random) -> None:
        self.corpus = corpus
        self.rng = rng

    def make(self) -> bytes:
        content = bytearray(self.rng.choice(self.corpus))
        for _ in range(self.rng.choice((1, 1, 1, 2, 3, 8, 30))):
            self.rng.choice(self.STEPS)(self, content)
        return bytes(content)

    def _at(self, content: bytearray) -> int:
        return self.rng.randrange(len(content) + 1)

    def _flip(self, content: bytearray) -> None:
        if content:
            content[self.rng.randrange(len(content))] ^= 1 << self.rng.randrange(8)

    def _byte(self, content: bytearray) -> None:
        if content:
            content[self.rng.randrange(len(content))] = self.rng.randrange(256)

    def _number(self, content: bytearray) -> None:
        size, order = self.rng.choice((1, 2, 4, 8)), self.rng.choice(("little", "big"))
        at = self._at(content)
        number = self.rng.choice(self.NUMBERS) % (1 << 8 * size)
        content[at : at + size] = number.to_bytes(size, order)  # type: ignore[arg-type]

    def _cut(self, content: bytearray) -> None:
        at = self._at(content)
        del content[at : at + self.rng.choice((1, 4, 100, 4096, len(content)))]

    def _double(self, content: bytearray) -> None:
        at, to = self._at(content), self._at(content)
        part = content[at : at + self.rng.choice((1, 8, 100, 4096))]
        content[to:to] = part * self.rng.choice((1, 1, 2, 100))

    def _blank(self, content: bytearray) -> None:
        at, size = self._at(content), self.rng.choice((4, 512, 4096))
        content[at : at + size] = bytes(len(content[at : at + size]))

    STEPS = (_flip, _byte, _byte, _number, _number, _cut, _double, _blank)
