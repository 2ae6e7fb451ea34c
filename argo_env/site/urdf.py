"""A site's elements as URDF: one fixed link for each material, one named solid for each part.

Few links with many solids, since PyBullet's collision step grows with the number of links: 30 µs
with 12 links of 250 boxes, 3 ms with 400 links of 8 boxes (one run on two cores).
"""

from functools import lru_cache
from xml.etree import ElementTree as ET

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


@lru_cache(maxsize=8)  # worlds of the same site are made again and again
def to_urdf(name: str, elements: tuple[Element, ...]) -> str:
    """The elements as one URDF document. Links are named after materials, solids after elements.

    Every tag stands on a line of its own: PyBullet cuts lines longer than 1,024 characters.
    """
    robot = ET.Element("robot", name=name)
    _add_inertial(ET.SubElement(robot, "link", name="site"))
    for material in sorted({e.material for e in elements}):
        red, green, blue = COLOURS[material]
        definition = ET.SubElement(robot, "material", name=material)
        ET.SubElement(definition, "color", rgba=f"{red} {green} {blue} 1")
        link = ET.SubElement(robot, "link", name=material)
        _add_inertial(link)
        for element in elements:
            if element.material == material:
                for number, solid in enumerate(element.solids):
                    _add_solid(link, f"{element.name} #{number}", solid, material)
        joint = ET.SubElement(robot, "joint", name=f"site_to_{material}", type="fixed")
        ET.SubElement(joint, "parent", link="site")
        ET.SubElement(joint, "child", link=material)
    ET.indent(robot)
    return ET.tostring(robot, encoding="unicode", xml_declaration=True) + "\n"


def _add_inertial(link: ET.Element) -> None:
    # The site never moves, but PyBullet asks for a mass.
    inertial = ET.SubElement(link, "inertial")
    ET.SubElement(inertial, "mass", value="1")
    ET.SubElement(inertial, "inertia", ixx="1", iyy="1", izz="1", ixy="0", ixz="0", iyz="0")


def _add_solid(link: ET.Element, name: str, solid: Solid, material: str) -> None:
    for kind in ("visual", "collision"):
        part = ET.SubElement(link, kind, name=name)
        ET.SubElement(part, "origin", xyz=_words(solid.center), rpy=_words(solid.rpy))
        geometry = ET.SubElement(part, "geometry")
        if isinstance(solid, Box):
            ET.SubElement(geometry, "box", size=_words(solid.size))
        else:
            ET.SubElement(
                geometry, "cylinder", radius=f"{solid.radius:.6g}", length=f"{solid.length:.6g}"
            )
        if kind == "visual":
            ET.SubElement(part, "material", name=material)


def _words(vector: Vector) -> str:
    # Adding 0.0 turns -0.0 into 0.0.
    return " ".join(f"{round(v, 6) + 0.0:.9g}" for v in vector)
