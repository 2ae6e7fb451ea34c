"""Whether what stands around orders may ask for something after all."""

import re
from functools import cache
from itertools import pairwise

from argo_compiler.script.syntax.text.source import Diagnostics, ScriptText
from argo_compiler.script.syntax.understanding import Understanding
from argo_compiler.script.syntax.words.joints import VERBS
from argo_compiler.script.syntax.words.lexicon import expand
from argo_compiler.script.syntax.words.loading import everywhere
from argo_compiler.script.syntax.words.word import Word

_MANNERS = frozenset(
    [
        *("DURATION", "SPEED", "TIMES", "AT_MOST", "MOST_TIME", "MOST_TIMES", "WITHIN", "LATEST"),
        *("EARLIEST", "IF_TIME", "ANY_ORDER", "THIS_ORDER", "RETRY", "MAX_DURATION", "BACK_IN"),
        *("PRIORITY", "RANKED", "BY_IMPORTANCE", "ENDLESS", "FINISHING", "STOPPING", "SPARE"),
        *("LEAVE_OUT", "ORDER_FREE", "ROUND_DRIVEN", "EXCEPT", "CANNOT"),
    ]
)
"""how, when and how often"""
ASKING = _MANNERS | {
    *("IF", "IF_ONLY", "UNLESS", "ELSE", "NOT", "UNTIL", "EVERY", "QUANTITY", "AT_LEAST"),
    *("GREATER", "LESS", "BETWEEN", "BE_MEASURED", "FAILS", "OCCURS"),
}
"""words of these types are in no title"""
NAMED = frozenset(["KIND", "HASH", "STEP", "AREA", "DOCK", "FLOOR"])
LABELS = frozenset(["NUMBER", "IDENT", "STRING", "HASH"])
_WHOLE = frozenset(["HOME", "END", "ABORT", "GO_ON", "RECHARGE", "PAUSE", "PARK"])
"""verbs that need nothing else"""
_PLACES = frozenset(["AREA", "DOCK", "PLACE", "FLOOR", "FLOOR_NAME", "LPAR", "X"])
"""where one may come from; `from` is no order beside anything else"""
_SINGLE = frozenset((verb,) for verb in VERBS)
_JOINTS = ("JOINT", "NEXT", "AND_", "OR_", "COLON")
_CLOCK = re.compile(r"\b[0-9]{1,2}[:.][0-9]{2}\b(?!\.)")
_TOKEN = re.compile(r"[\w'-]+|[^\w\s]")


class Asking:
    """Tells texts that may ask for something."""

    def __init__(self, understanding: Understanding) -> None:
        self.understanding = understanding
        self.prose = understanding.language.prose

    def names(self, text: ScriptText) -> bool:
        """Whether a text names a checkpoint, a starting area or a step."""
        types = self.understanding.types(text)
        return any(a in NAMED and b in LABELS for a, b in pairwise(types))

    def asks(self, text: ScriptText, counted: bool = False) -> bool:
        """Whether a text that makes no sense may ask for something; in a title runs and tests may
        be counted: `Team 4, run 2`."""
        types = self.understanding.types(text)
        if ASKING & {*types} or self.orders(text, counted):
            return True
        if ("HASH", "KIND") in pairwise(types):
            return True  # `no valves today`
        numbered = types[1:3] != ("STEP", "IDENT")  # `Work instruction WI-31` is a title
        if len(types) > 2 and types[0] == "WORD" and types[1] in NAMED and numbered:
            found = self.understanding.words(text)
            counted = types[1] == "HASH" and text.content[found[1].start] != "#"
            return types[2] in LABELS and not counted  # `Protocol no. 4` is a title
        return self._has_object(text.content)

    def orders(self, text: ScriptText, counted: bool = False) -> bool:
        """Whether a verb of the robot's stands in a text as it does in an order."""
        nouns = phrases_of(self.prose.counted) if counted else frozenset()
        found = self.understanding.words(text)
        types = [word.type for word in found]
        for i, type_ in enumerate(types):
            if type_ not in VERBS or (type_ == "FROM" and not _PLACES & {*types}):
                continue
            after = types[i + 1] if i + 1 < len(types) else ""
            named = type_ != "MEASURE" or types[i - 1] == "WORD"  # not `Plan, test 12`
            if i > 0 and after == "NUMBER" and named and _said(text, found[i]) in nouns:
                continue
            joined = i > 0 and (bool(found[i].before) or types[i - 1].startswith(_JOINTS))
            said = text.content[found[i].end :].split()[:1]
            if (i == 0 or joined) and after and said != ["of"]:
                return True
            if (joined and type_ in _WHOLE) or after in NAMED | LABELS | {"ALL", "IT"}:
                return True
        return False

    def bids(self, text: ScriptText) -> bool:
        """Whether a remark says what is to be done, or how."""
        types = self.understanding.types(text)
        return bool(_MANNERS & {*types}) or self.orders(text) or types[:1] in _SINGLE

    def sets_aside(self, heading: ScriptText) -> bool:
        """Whether a heading may say that what stands below it is not to be done, or not always."""
        types = self.understanding.types(heading)
        timed = types[:1] in (("BEFORE",), ("AFTER",)) or _CLOCK.search(heading.content) is not None
        return timed or _limits(heading, "set_aside", "past")

    def corrects(self, remark: ScriptText) -> bool:
        """Whether a remark may take something back, or say when or how it is done."""
        return _limits(remark, "set_aside", "correcting")

    def ranks(self, text: ScriptText) -> bool:
        """Whether a text says of a kind only when it is done: `The valves come first`."""
        types = self.understanding.types(text)
        words = text.content.strip(" .!:").lower().split()
        ends = {*words[:1], *words[-1:]}
        return (
            types[:1] == ("KIND",)
            and len(types) <= 3
            and {*types[1:]} <= {"BE_MEASURED", "WORD"}
            and not ends.isdisjoint(phrases_of(self.prose.foremost))
        )

    def adds(self, text: ScriptText) -> bool:
        """Whether a part of a sentence may say something of its order: `(and 4)`, `(go home)`."""
        found = self.understanding.words(text)
        types = [word.type for word in found]
        sides = any(a in ("BEFORE", "AFTER") and b in NAMED | LABELS for a, b in pairwise(types))
        opens = bool(found) and (
            found[0].before != ""
            or types[0] in VERBS
            or types[0] == "JOINT"
            or types[0].startswith(("OR_", "AND_"))
        )
        return sides or opens or {*types} <= LABELS or self.asks(text) or self.names(text)

    def _has_object(self, content: str) -> bool:
        """Whether an article stands where that of a verb's object does: `send an SMS`."""
        tokens = [token.lower() for token in _TOKEN.findall(content)]
        article, before = phrases_of(self.prose.determiner), phrases_of(self.prose.preposition)
        return any(
            token in article
            and after[0].isalpha()
            and last[0].isalpha()
            and last not in before
            and last not in article
            for last, token, after in zip(tokens, tokens[1:], tokens[2:], strict=False)
        )


def ask_of_remark(remark: ScriptText, diagnostics: Diagnostics) -> None:
    """Asks about a remark that may not be one."""
    message = f"`{remark.content}` may change what is done, or be a remark"
    hint = "write what is done as it is meant, or leave this out"
    diagnostics.error("ambiguous-remark", message, remark.span(), hint)


def _limits(text: ScriptText, *names: str) -> bool:
    """Whether a text has words of these names, or is one that says when something is done."""
    words = "|".join(map(everywhere, names))
    whole = text.content.strip(" :.!?()*_")
    return bool(
        re.search(rf"\b(?:{words})\b", text.content, re.IGNORECASE)
        or re.fullmatch(everywhere("in_some_case"), whole, re.IGNORECASE)
    )


def _said(text: ScriptText, word: Word) -> str:
    return text.content[word.start : word.end].lower()


@cache
def phrases_of(phrases: str) -> frozenset[str]:
    """The phrases that bars separate."""
    return frozenset(expand(phrases))
