"""An open text, with what it mentions, for which choices are looked for."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from argo_compiler.base.catalog import CheckpointInfo
from argo_compiler.script.documents.source import ScriptText
from argo_compiler.script.proposals.composing import Composer
from argo_compiler.script.proposals.demands import Demands, demands_of, named_by, returns, tells
from argo_compiler.script.proposals.frames import Sentences, length_words
from argo_compiler.script.proposals.mentions import Mention, Mentions, checkpoint_words
from argo_compiler.script.sentences.tree.places import AreaLocation, DockLocation
from argo_compiler.script.sentences.words.numbers import Figure

HOME = ("home", "HOME", "DOCK")
"""kinds of mentions that send the robot back"""
ENDS = ("END", "ABORT")
"""kinds of mentions that end the mission"""

_AT = ("AT", "IN", "TO", "ON", "FROM")
_WHEN = ("AT", "AFTER", "IN")
"""types of words before a time when something is done"""


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
        words = self.composer.understanding.words(self.text)
        return named_by(mention, words, self.composer.known)

    @cached_property
    def demands(self) -> Demands:
        """Return the demands that each choice of the text has to respect."""
        return demands_of(self.text, self.found, self.composer.known)

    def tells(self, name: str) -> bool:
        """Return True if the text has one of the phrases of a cue, such as `trying`."""
        return tells(name, self.text, self.composer.known)

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
        numbered = self.found.has("AREA")
        docking = self.found.has("place", "DOCK", "HOME", "home")
        areas: list[int | None] = []
        for mention in self.found.of("place", "NUMBER"):
            place = mention.value
            if isinstance(place, DockLocation):
                place = place.area
            if isinstance(place, AreaLocation):
                areas.append(place.area)
            elif isinstance(place, Figure):
                at = docking and self.type_before(mention) in _AT  # `dock at 2`
                areas += [place.whole] if at or numbered else []
        known = self.composer.known.catalog
        return [area for area in areas if area is not None and known.area(area)]

    @property
    def comes_back(self) -> bool:
        """Return True if the text names one area, in which the robot starts and ends."""
        homewards = self.found.has("home", "HOME", "END")
        return self.found.has("start", "START") and homewards and len(self.areas) == 1

    @property
    def return_words(self) -> str:
        """The words that send the robot back, to the area that the text names if it names one."""
        starts = self.found.has("start", "START") and not self.comes_back
        areas = self.areas[1:] if starts else self.areas
        area = next((a for a in areas if self.composer.known.catalog.area(a)), None)
        if area is None and self.found.has("same_area"):
            area = self.composer.known.start_area
        where = "" if area is None else f" in starting area {area}"
        return f"return to the docking station{where}"

    def is_limited(self, found: Mentions) -> bool:
        """Return True if times that are mentioned may be limits: `home within 45 min`."""
        limits = [m for m in found.of("limit") if not self._is_of_reading(m)]
        limited = found.has("WITHIN", "AT_MOST", "LATEST", "MOST_TIME", "MAX_DURATION", "TOTAL")
        return bool(limits) or limited or any(map(self._ends, found.of("DURATION")))

    def _is_of_reading(self, limit: Mention) -> bool:
        """Return True for `below` in `below 4 bar`."""
        behind = [m.kind for m in self.found.mentions if m.start >= limit.end]
        return behind[:1] == ["QUANTITY"]

    def _ends(self, length: Mention) -> bool:
        """Return True for a time by which, or at which something is over: `by 20 minutes`."""
        before = self.type_before(length)
        homewards = self.found.has(*HOME, *ENDS) or self.comes_back
        return before in ("BY", "LATEST", "UNTIL") or (before in _WHEN and homewards)

    def type_before(self, mention: Mention) -> str:
        """Return the type of the word right before a part; empty if there is none."""
        words = self.composer.understanding.words(self.text)
        before = [word for word in words if word.end <= mention.start]
        return max(before, key=lambda word: word.end).type if before else ""

    def words_of(self, ids: Sequence[int]) -> str:
        """Return checkpoints by their numbers."""
        catalog = {c.id: c for c in self.composer.known.catalog.checkpoints}
        return checkpoint_words([catalog[id] for id in ids])

    def leaving_out(self, ids: Sequence[int]) -> Sentences:
        """Return how checkpoints are left out: those that are asked for above are deleted."""
        old = [id for id in ids if id in self.above]
        new = [id for id in ids if id not in self.above]
        pairs = (("Delete", old), ("Do not check", new))
        return tuple(f"{verb} {self.words_of(some)}." for verb, some in pairs if some)

    def acts(self, mentions: Mentions, subject: CheckpointInfo | None = None) -> list[str]:
        """Return what a text asks for, in its order: to start, to wait, to check, to end or to
        return. `subject`: the checkpoint that `again` means."""
        acts: list[str] = []
        waits: list[str] = []
        """for what is named next"""
        limited = self.is_limited(mentions)
        for mention in mentions.mentions:
            if mention.kind == "checkpoints":
                named = [c for c in self.named_by(mention) if c.id not in self.demands.spared]
                acts += [*waits, f"check {checkpoint_words(named)}"] if named else []
                waits = [] if named else waits
            elif mention.kind == "DURATION" and (length := length_words(mention.value)):
                checked = bool(acts) and acts[-1].startswith("check")
                if limited or self.found.has("EVERY"):
                    continue  # `home within 45 min`
                if self.type_before(mention) not in _WHEN:
                    acts.append(f"wait for {length}")
                elif checked:  # `check R12 in 10 minutes`
                    acts.insert(-1, f"wait for {length}")
                else:
                    waits.append(f"wait for {length}")
        acts += waits
        checks = any(act.startswith("check") for act in acts)
        homewards = returns(mentions) or mentions.has(*ENDS)
        if mentions.has("again", "MORE", "RETRY") and subject is not None and not checks:
            acts += [] if homewards else [f"check checkpoint {subject.id} again"]
        starts = mentions.has("start", "START") and not mentions.has("home", "HOME", "END")
        docks = any(isinstance(m.value, DockLocation | AreaLocation) for m in mentions.of("place"))
        if starts and self.areas:
            acts.insert(0, f"start in starting area {self.areas[0]}")
        elif docks or mentions.has("HOME", "DOCK"):
            acts.append(self.return_words)
        elif mentions.has(*ENDS):
            acts.append("abort the mission")
        elif mentions.has("home"):
            acts.append(self.return_words)
        return acts


def as_sentences(acts: Sequence[str]) -> Sentences:
    """Return acts as sentences: `wait for 5 minutes` as `Wait for 5 minutes.`"""
    return tuple(f"{act[0].upper()}{act[1:]}." for act in acts)
