"""URDF of a site's elements: one fixed link for each material, with one entry for each solid.

There are few links with many solids, as the time of PyBullet's collision step grows with the number
of links: 30 µs with 12 links of 250 boxes, 3 ms with 400 links of 8 boxes (one run on two cores).
"""

from functools import lru_cache
from xml.sax.saxutils import quoteattr

from argo_env.site.shapes import Box, Element, Solid, Vector

COLOURS: dict[str, tuple[float, float, float]] = {
    "gravel": (0.66, 0.62, 0.56),
    "concrete": (0.78, 0.78, 0.76),
    "grating": (0.55, 0.59, 0.63),
    "railing": (0.93, 0.74, 0.12),
    "structure": (0.36, 0.42, 0.50),
    "vessel": (0.80, 0.83, 0.86),
    "pipe": (0.36, 0.58, 0.62),
    "pump": (0.24, 0.45, 0.35),
    "dock": (0.16, 0.36, 0.66),
    "brick": (0.70, 0.32, 0.24),
}
"""Red, green and blue from 0 to 1 for each material."""


@lru_cache(maxsize=32)  # worlds of a site, and its storeys, are made many times
def to_urdf(name: str, elements: tuple[Element, ...], with_visual_shapes: bool = True) -> str:
    """Return the text of one URDF document with the elements, whose robot is named `name`.

    Each material has one link, named after it, with the solids of all its elements; solids are
    named after their elements. If `with_visual_shapes` is False, pictures show none of the solids,
    and PyBullet loads the document in half the time.

    Every tag has a line of its own, as PyBullet cuts lines longer than 1,024 characters.
    """
    # A site has thousands of solids: writing text is much faster than building a tree of tags.
    lines = ['<?xml version="1.0" encoding="UTF-8"?>', f"<robot name={quoteattr(name)}>"]
    lines += ['<link name="site">', *_INERTIAL, "</link>"]
    for material in sorted({e.material for e in elements}):
        red, green, blue = COLOURS[material]
        lines += [
            f'<material name="{material}">',
            f'<color rgba="{red} {green} {blue} 1" />',
            "</material>",
            f'<link name="{material}">',
            *_INERTIAL,
        ]
        for element in elements:
            if element.material == material:
                for number, solid in enumerate(element.solids):
                    lines += _solid(
                        f"{element.name} #{number}", solid, material, with_visual_shapes
                    )
        lines += [
            "</link>",
            f'<joint name="site_to_{material}" type="fixed">',
            '<parent link="site" />',
            f'<child link="{material}" />',
            "</joint>",
        ]
    return "\n".join([*lines, "</robot>", ""])


# The site never moves, but PyBullet requires a mass.
_INERTIAL = (
    "<inertial>",
    '<mass value="1" />',
    '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0" />',
    "</inertial>",
)


def _solid(name: str, solid: Solid, material: str, with_visual_shapes: bool) -> list[str]:
    quoted = quoteattr(name)
    if isinstance(solid, Box):
        shape = f'<box size="{_numbers_text(solid.size)}" />'
    else:
        shape = f'<cylinder radius="{solid.radius:.6g}" length="{solid.length:.6g}" />'
    geometry = [
        f'<origin xyz="{_numbers_text(solid.center)}" rpy="{_numbers_text(solid.rpy)}" />',
        "<geometry>",
        shape,
        "</geometry>",
    ]
    shown = [f"<visual name={quoted}>", *geometry, f'<material name="{material}" />', "</visual>"]
    return [
        *(shown if with_visual_shapes else ()),
        f"<collision name={quoted}>",
        *geometry,
        "</collision>",
    ]


def _numbers_text(vector: Vector) -> str:
    # Adding 0.0 turns -0.0 into 0.0.
    return " ".join([f"{round(v, 6) + 0.0:.9g}" for v in vector])
