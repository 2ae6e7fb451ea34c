"""An open text, with what it mentions, for which choices are looked for."""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass

from argo_compiler.base.catalog import CheckpointInfo
from argo_compiler.script.documents.source import RefusedError, ScriptText
from argo_compiler.script.proposals.composing import Composer
from argo_compiler.script.proposals.frames import Sentences, length_words
from argo_compiler.script.proposals.mentions import Mention, Mentions, checkpoint_words
from argo_compiler.script.sentences.tree.places import AreaLocation, DockLocation
from argo_compiler.script.sentences.words.numbers import Figure

HOME = ("home", "HOME", "DOCK")
"""kinds of mentions that send the robot back"""
ENDS = ("END", "ABORT")
"""kinds of mentions that end the mission"""
_SPARING = ("forbidding", "NOT", "leave_out", "EXCEPT", "SPARE", "DELETE")


@dataclass(frozen=True)
class OpenText:
    """A text that is not understood, and the parts of it that mean something."""

    text: ScriptText
    found: Mentions
    composer: Composer
    above: tuple[int, ...]
    """the checkpoints that are measured before it"""

    def named_by(self, mention: Mention) -> list[CheckpointInfo]:
        """Return the checkpoints that a part names; none if that is not clear."""
        with suppress(RefusedError):
            return self.composer.known.checkpoints([mention])
        return []

    def counts(self, *kinds: str) -> list[int | None]:
        """Return the numbers of mentions of these kinds; None for one that is not clear."""
        values = (mention.value for mention in self.found.of(*kinds))
        return [value.whole for value in values if isinstance(value, Figure)]

    def lengths(self, *kinds: str) -> list[str | None]:
        """Return the times of mentions of these kinds in words; None for one that is not clear."""
        return [length_words(mention.value) for mention in self.found.of(*kinds)]

    @property
    def types(self) -> tuple[str, ...]:
        """The types of the words, also of those that are part of a larger mention."""
        return self.composer.understanding.types(self.text)

    @property
    def areas(self) -> list[int]:
        """The numbers of the areas that are named; also of `starting area is 2`."""
        places = (mention.value for mention in self.found.of("place"))
        docks = (one.area if isinstance(one, DockLocation) else one for one in places)
        areas = [place.area for place in docks if isinstance(place, AreaLocation)]
        numbers = self.counts("NUMBER")
        return areas or [n for n in numbers if n is not None and self.found.has("AREA")]

    @property
    def return_words(self) -> str:
        """The words that send the robot back, to the area that the text names if it names one."""
        area = next((a for a in self.areas if self.composer.known.catalog.area(a)), None)
        if area is None and self.found.has("same_area"):
            area = self.composer.known.start_area
        where = "" if area is None else f" in starting area {area}"
        return f"return to the docking station{where}"

    def acts(self, mentions: Mentions, subject: CheckpointInfo | None = None) -> list[str]:
        """Return what a text asks for, in its order: to wait, to check, to end or to return.
        `subject`: the checkpoint that `again` means."""
        acts: list[str] = []
        spared = False
        limited = mentions.has("limit", "WITHIN", "AT_MOST", "LATEST", "MOST_TIME")
        for mention in mentions.mentions:
            spared = mention.kind in _SPARING or (spared and mention.kind == "MEASURE")
            if mention.kind == "checkpoints" and not spared:
                named = self.named_by(mention)
                acts += [f"check {checkpoint_words(named)}"] if named else []
            elif limited:
                continue  # `home within 45 min`
            elif mention.kind == "DURATION" and (length := length_words(mention.value)):
                acts.append(f"wait for {length}")
        checks = any(act.startswith("check") for act in acts)
        if mentions.has("again", "MORE", "RETRY") and subject is not None and not checks:
            acts.append(f"check checkpoint {subject.id} again")
        docks = any(isinstance(m.value, DockLocation | AreaLocation) for m in mentions.of("place"))
        if docks or mentions.has("HOME", "DOCK"):
            acts.append(self.return_words)
        elif mentions.has(*ENDS):
            acts.append("abort the mission")
        elif mentions.has("home"):
            acts.append(self.return_words)
        return acts


def as_sentences(acts: Sequence[str]) -> Sentences:
    """Return acts as sentences: `wait for 5 minutes` as `Wait for 5 minutes.`"""
    return tuple(f"{act[0].upper()}{act[1:]}." for act in acts)
