"""How the canonical script names places."""

import re

from argo_compiler.base.catalog import Catalog
from argo_compiler.base.model import Pose
from argo_compiler.script.syntax.words.language import Language
from argo_compiler.script.syntax.words.lexer import words
from argo_compiler.script.write.text import point

_WORDS = re.compile(r"[a-z]+(?: [a-z]+)*")


class Places:
    """The site's places by their poses, as a script names them."""

    def __init__(self, catalog: Catalog) -> None:
        language = Language.of("", [place.name for place in catalog.places])
        self._areas = {area.dock: area.number for area in reversed(catalog.areas)}
        self._docks = {area.number: area.dock for area in reversed(catalog.areas)}
        self._names = {
            place.pose: f"the {place.name}"
            for place in reversed(catalog.places)
            if _WORDS.fullmatch(place.name) and _is_place(place.name, language)
        }

    def dock(self, area: int) -> Pose | None:
        """The docking station in the starting area of this number."""
        return self._docks.get(area)

    def name(self, pose: Pose) -> str | None:
        """What the site calls the place with this pose."""
        return self._names.get(pose)

    def location(self, pose: Pose) -> str:
        """The pose as a place or area of the site if it is one, else in coordinates."""
        if pose in self._names:
            return self._names[pose]
        return f"starting area {self._areas[pose]}" if pose in self._areas else point(pose)


def _is_place(name: str, language: Language) -> bool:
    """Whether the words stand for that place, and for nothing else, behind `go to`."""
    found = words(f"go to the {name}", language.lexicon)
    return [word.type for word in found] == ["GO", "PLACE"] and found[1].value == name
