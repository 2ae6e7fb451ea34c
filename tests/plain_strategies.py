"""Replacement of `hypothesis.strategies` in campaigns: the same names, with simple draws.

Most of the time of a random mission is Hypothesis's own, which keeps what it needs for making an
example smaller. A campaign draws anew from the number of the example instead.
"""

import random


class Strategy:
    """Function that draws a value from a random generator."""

    def __init__(self, draw):
        self.draw = draw

    def map(self, change):
        return Strategy(lambda rng: change(self.draw(rng)))


def just(value):
    return Strategy(lambda _: value)


def none():
    return just(None)


def booleans():
    return Strategy(lambda rng: rng.random() < 0.5)


def integers(low, high):
    return Strategy(lambda rng: rng.randint(low, high))


def sampled_from(values):
    values = list(values)
    return Strategy(lambda rng: rng.choice(values))


def one_of(*strategies):
    return Strategy(lambda rng: rng.choice(strategies).draw(rng))


def tuples(*parts):
    return Strategy(lambda rng: tuple(part.draw(rng) for part in parts))


def lists(element, min_size=0, max_size=10, unique=False):
    def draw(rng):
        found = []
        count = rng.randint(min_size, max_size)
        while count > 0:
            value = element.draw(rng)
            # There may be fewer different ones than were drawn as their number.
            if not unique or value not in found:
                found.append(value)
            elif len(found) < min_size:
                continue
            count -= 1
        return found

    return Strategy(draw)


def permutations(values):
    return Strategy(lambda rng: rng.sample(list(values), len(values)))


def builds(make, *parts, **fields):
    return Strategy(
        lambda rng: make(
            *(part.draw(rng) for part in parts),
            **{name: part.draw(rng) for name, part in fields.items()},
        )
    )


def composite(make):
    def strategy(*args, **fields):
        return Strategy(lambda rng: make(lambda part: part.draw(rng), *args, **fields))

    return strategy


def example(strategy, number):
    """Return the example with this number."""
    return strategy.draw(random.Random(number))
