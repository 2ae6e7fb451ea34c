"""Sites as pictures: what lies outside of the ground is drawn too, and long errors in full."""

import io

import pytest
from PIL import Image

from argo_env.pictures.site_plan import draw_site
from argo_env.planning.flaws.flaw import Flaw, Mark
from argo_env.site import load_site


@pytest.mark.parametrize("words", [1, 100])
def test_a_mark_far_outside_is_drawn_at_the_edge(words):
    site = load_site("darmstadt")
    flaw = Flaw("wrong " * words, (Mark(1, -500.0, 900.0),))
    drawn = Image.open(io.BytesIO(draw_site(site, [flaw])))
    plain = Image.open(io.BytesIO(draw_site(site)))
    assert plain.size == (1280, 720)
    assert drawn.height == 720 + 17 * (2 if words == 1 else 4 + 1)
    corner = (0, 60, 60, 300)  # the north-west of floor 1
    assert drawn.crop(corner).tobytes() != plain.crop(corner).tobytes()
