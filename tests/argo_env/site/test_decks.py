"""Decks are compared with a boolean raster of half-metre fields."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_env.site.build import Deck

FIELD = 0.5
SIDE = 10  # fields


@st.composite
def rectangles(draw):
    x0, y0 = draw(st.integers(0, SIDE - 1)), draw(st.integers(0, SIDE - 1))
    x1, y1 = draw(st.integers(x0 + 1, SIDE)), draw(st.integers(y0 + 1, SIDE))
    return tuple(FIELD * v for v in (x0, y0, x1, y1))


some = st.lists(rectangles(), min_size=1, max_size=5).map(tuple)
few = st.lists(rectangles(), max_size=3).map(tuple)


def raster(areas):
    fields = np.zeros((SIDE, SIDE), dtype=int)
    for x0, y0, x1, y1 in areas:
        i0, j0, i1, j1 = (round(v / FIELD) for v in (x0, y0, x1, y1))
        fields[i0:i1, j0:j1] += 1
    return fields


def perimeter(fields):
    padded = np.pad(fields.astype(int), 1)
    return FIELD * (np.abs(np.diff(padded, axis=0)).sum() + np.abs(np.diff(padded, axis=1)).sum())


def pieces(edge):
    """Return the middles of the edge's pieces, each as long as one field."""
    start, end = np.array(edge.start), np.array(edge.end)
    count = round(np.abs(end - start).sum() / FIELD)
    return [start + (k + 0.5) / count * (end - start) for k in range(count)]


def at(fields, point):
    i, j = np.floor(np.array(point) / FIELD).astype(int)
    return bool(0 <= i < SIDE and 0 <= j < SIDE and fields[i, j])


@given(some, few)
@settings(max_examples=150, deadline=None)
def test_plates_cover_the_deck_once(walkways, openings):
    wanted = (raster(walkways) > 0) & (raster(openings) == 0)
    assert (raster(Deck.from_rectangles(walkways, openings).plates()) == wanted).all()


@given(some, few)
@settings(max_examples=150, deadline=None)
def test_free_edges_are_the_rim(walkways, openings):
    wanted = (raster(walkways) > 0) & (raster(openings) == 0)
    edges = Deck.from_rectangles(walkways, openings).edges_outside_gaps(())
    length = sum(np.abs(np.subtract(e.end, e.start)).sum() for e in edges)
    assert abs(length - perimeter(wanted)) < 1e-9
    for edge in edges:
        assert edge.start != edge.end
        for middle in pieces(edge):
            assert at(wanted, middle - 0.01 * np.array(edge.outward))
            assert not at(wanted, middle + 0.01 * np.array(edge.outward))


@given(some, few, few)
@settings(max_examples=150, deadline=None)
def test_gaps_stay_open_and_nothing_else(walkways, openings, gaps):
    deck = Deck.from_rectangles(walkways, openings, gaps)
    everywhere = {
        (*np.round(m, 6).tolist(), e.outward)
        for e in deck.edges_outside_gaps(())
        for m in pieces(e)
    }
    kept = {
        (*np.round(m, 6).tolist(), e.outward)
        for e in deck.edges_outside_gaps(gaps)
        for m in pieces(e)
    }
    open_ = {
        piece
        for piece in everywhere
        if any(x0 <= piece[0] <= x1 and y0 <= piece[1] <= y1 for x0, y0, x1, y1 in gaps)
    }
    assert kept == everywhere - open_
