"""Questions in the terminal about the lines of a draft that are left, one key a line."""

import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from argo_compiler.base.errors import Invalid
from argo_compiler.script import Draft, DraftActs, DraftLine, LineState
from argo_compiler.script.documents.source import Source
from argo_compiler.script.drafts.naming_nothing import lines_naming_nothing
from argo_planner.terminal import keyboard
from argo_planner.terminal.draft_decisions import Deciding
from argo_planner.terminal.draft_display import printable
from argo_planner.terminal.draft_files import require_draft_writable, write_draft
from argo_planner.terminal.files import STANDARD_OUTPUT
from argo_planner.terminal.keyboard import read_key, read_line
from argo_planner.terminal.signals import Interrupted

_LONGEST = 200
"""characters of a line that are shown"""
_MOST_LINES = 12
"""lines of the script that are shown of one that goes over several"""
_MOST_CHOICES = 9
"""choices that a key can take"""
_HELP = """\
c     confirm: the sentences behind => count for this line
1..9  choose: the sentences of this choice count
a     set aside: the line has no effect
r     set aside the rest: all lines that can only be set aside and name nothing of a mission; they
      are listed first
s     say the line in other words: type sentences, Enter ends them, and an empty line goes back
n     next: skip this line for now; so does the space bar
u     undo the last decision
q     quit: lines that are left stay in the draft; so does Ctrl-D"""


def require_terminal(output: Path) -> None:
    """Raise Invalid unless a person can be asked in the terminal."""
    if output == STANDARD_OUTPUT:
        raise Invalid("--interactive asks on standard output: name a file for the mission")
    if not (sys.stdin.isatty() and sys.stdout.isatty()):
        raise Invalid(
            "--interactive needs a terminal: without one, decide by --confirm, --set-aside, --say "
            "and --choose"
        )


def ask_about_lines(deciding: Deciding) -> None:
    """Ask about each line that is left, and write the draft after each decision.

    Raises:
        ArgoError: The draft can't be written beside the script.
    """
    require_draft_writable(deciding.script)
    try:
        _Dialogue(deciding).run()
    except Interrupted:
        print()  # the message begins a line of its own
        raise


class _Dialogue:
    """Goes through the lines that are left. Mutable."""

    def __init__(self, deciding: Deciding) -> None:
        self.deciding = deciding
        self.source = Source(deciding.draft.text)
        self.next_place = (0, 0)
        """line and part from which lines are asked about"""
        self.before: list[tuple[Draft, tuple[int, int]]] = []
        """the draft before each decision, and the line that it was about"""
        self.idle: tuple[Draft, Sequence[DraftLine]] | None = None
        """a draft, and its lines that name nothing"""

    def run(self) -> None:
        """Ask until no line is left, or the person quits."""
        while (line := self._next()) is not None:
            print("\n".join(["", *self._shown(line)]))
            if not self._ask(line):
                return

    def _next(self) -> DraftLine | None:
        left = self.deciding.draft.left
        return next((line for line in left if _place(line) >= self.next_place), None)

    def _ask(self, line: DraftLine) -> bool:
        """Ask until the line is decided on or skipped; return False if the person quits."""
        idle = self._naming_nothing(line)
        keys = f"{', '.join(_keys(line, bool(self.before), len(idle)))}: "
        while True:
            print(keys, end="", flush=True)
            match read_key().lower():
                case "q" | keyboard.INPUT_ENDED:
                    print("quit")
                    return False
                case "n" | " ":
                    print("skipped")
                    self.next_place = _after(line)
                    return True
                case "u" if self.before:
                    print("undone")
                    self._undo()
                    return True
                case "r" if idle:
                    if self._set_aside_all(line, idle):
                        return True
                case "?":
                    print(f"help\n{_HELP}")
                case "s":
                    if self._say(line):
                        return True
                case key:
                    act = _act(line, key)
                    if act is None:
                        print("no such key here; ? for help")
                    elif self._decide(line, *act):
                        return True

    def _say(self, line: DraftLine) -> bool:
        """Read sentences that count instead of a line, again as long as they are not understood.

        Returns:
            True if they count now; False after an empty line.
        """
        print("say")
        while True:
            print(f"line {line.label}, in other words: ", end="", flush=True)
            typed = read_line()
            sentence = " ".join((typed or "").split())
            if typed is None:
                print()
            if not sentence:
                return False
            if not sentence.isprintable():
                print("the sentence has characters that can't be printed")
            elif self._decide(line, DraftActs(say=((line.label, (sentence,)),)), ""):
                return True

    def _naming_nothing(self, line: DraftLine) -> Sequence[DraftLine]:
        """Return the lines that name nothing, if `line` is one of several."""
        if line.choices != ((),):
            return ()
        draft = self.deciding.draft
        if self.idle is None or self.idle[0] is not draft:
            self.idle = draft, lines_naming_nothing(draft, self.deciding.site.catalog)
        found = self.idle[1]
        return found if len(found) > 1 and line in found else ()

    def _set_aside_all(self, line: DraftLine, idle: Sequence[DraftLine]) -> bool:
        """List lines, and set them aside if the person agrees; return True if that is done."""
        print("the rest")
        print("\n".join(f"  {one.label:>5} | {_cut(one.text)}" for one in idle))
        print(f"set these {len(idle)} lines aside? y yes, any other key no: ", end="", flush=True)
        if read_key().lower() != "y":
            print("no")
            return False
        labels = tuple(one.label for one in idle)
        return self._decide(line, DraftActs(set_aside=labels), "set aside")

    def _decide(self, line: DraftLine, acts: DraftActs, message: str) -> bool:
        """Carry out acts on a line and write the draft; return False if that is impossible."""
        before = self.deciding.draft
        try:
            self.deciding.perform(acts)
        except Invalid as error:
            print(printable(str(error)))
            return False
        if message:
            print(message)
        self.before.append((before, _place(line)))
        self.next_place = _place(line)  # it is asked about again if it is still left
        write_draft(self.deciding.script, self.deciding.draft)
        return True

    def _undo(self) -> None:
        self.deciding.draft, self.next_place = self.before.pop()
        write_draft(self.deciding.script, self.deciding.draft)

    def _shown(self, line: DraftLine) -> Iterator[str]:
        """Yield the line with its neighbours in the script, and what it would become."""
        left = len(self.deciding.draft.left)
        yield f"{self.deciding.draft.source_name}, line {line.label} ({left} left)"
        rows = self.source.lines
        last = min(line.last_line, line.line + _MOST_LINES)
        for number in range(max(line.line - 1, 1), min(last + 1, len(rows)) + 1):
            mark = ">" if line.line <= number <= line.last_line else " "
            yield f"{mark} {number:>5} | {_cut(rows[number - 1])}"
        if line.parts > 1:
            yield f"part {line.label}: {_cut(line.text)}"
        if line.sentences:
            yield f"=> {' '.join(line.sentences)}"
        if line.unused:
            yield f"not used: {printable(', '.join(line.unused))}"
        if line.reason:
            yield f"{line.state}: {printable(line.reason)}"
        if line.hint:
            yield f"hint: {printable(line.hint)}"
        for number, sentences in enumerate(line.choices[:_MOST_CHOICES], start=1):
            yield f"{number}: {' '.join(sentences) or '(set it aside)'}"


def _act(line: DraftLine, key: str) -> tuple[DraftActs, str] | None:
    """Return what a key does with a line, and the message about it; None if it does nothing."""
    if key == "a":
        return DraftActs(set_aside=(line.label,)), "set aside"
    if key == "c" and line.state is LineState.PROPOSED:
        return DraftActs(confirm=(line.label,)), "confirmed"
    if key in _digits(line):
        sentences = line.choices[int(key) - 1]
        return DraftActs(choose=((line.label, int(key)),)), " ".join(sentences) or "set aside"
    return None


def _keys(line: DraftLine, can_undo: bool, idle: int) -> Iterator[str]:
    """Yield the keys that do something with a line."""
    if line.state is LineState.PROPOSED:
        yield "c confirm"
    if digits := _digits(line):
        yield f"{digits[0]}-{digits[-1]} choose" if len(digits) > 1 else "1 choose"
    yield "a set aside"
    if idle:
        yield f"r set aside the rest that names nothing ({idle})"
    yield from ("s say", "n next")
    if can_undo:
        yield "u undo"
    yield from ("q quit", "? help")


def _digits(line: DraftLine) -> Sequence[str]:
    return [str(number) for number in range(1, min(len(line.choices), _MOST_CHOICES) + 1)]


def _place(line: DraftLine) -> tuple[int, int]:
    return line.line, line.part


def _after(line: DraftLine) -> tuple[int, int]:
    return line.line, line.part + 1


def _cut(text: str) -> str:
    return printable(text if len(text) <= _LONGEST else f"{text[:_LONGEST]}...")
