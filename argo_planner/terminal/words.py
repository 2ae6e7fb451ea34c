"""Messages of the libraries in the words of the command line: which option or command helps."""

import shlex
from collections.abc import Iterable
from typing import TYPE_CHECKING

from argo_compiler.base.errors import ArgoError, Remedy
from argo_compiler.base.listing import listed

if TYPE_CHECKING:
    from argo_compiler.diagnostics import Diagnostic

_WORDS = {
    Remedy.CHECK_MISSION: "argo check MISSION",
    Remedy.CHOOSE_AREAS: "--start-area and --end-area",
    Remedy.CHOOSE_START: "--start-area",
    Remedy.CHOOSE_END: "--end-area",
    Remedy.CHOOSE_SITE: "--site",
    Remedy.CHOOSE_OUTPUT: "--out",
    Remedy.CHOOSE_PLAN: "--plan",
    Remedy.FILM_INSTEAD: "--render instead of --gui",
    Remedy.GIVE_BUDGET: "--budget",
    Remedy.SEARCH_LONGER: "--time-limit",
    Remedy.KEEP_JOURNAL: "argo run --journal",
    Remedy.RESUME: "argo resume {about}",
    Remedy.REPLAY: "argo replay {about}",
    Remedy.RUN_ANEW: "argo run",
    Remedy.RECORD: "argo run --record",
    Remedy.REPLACE: "--force",
    Remedy.SHOW_REST: "argo replay without options",
}


def said(error: ArgoError, prefix: str = "") -> str:
    """The message of an error with the options and commands that help. The `prefix` goes before
    what does not begin with the name of a file."""
    # Slow to import, and most commands end well.
    from argo_compiler.diagnostics import DiagnosticError, to_text

    if isinstance(error, DiagnosticError):
        return to_text(with_options(error.diagnostics), error.source_name)
    return f"{prefix}{error}{_ways(error.remedies, error.about)}"


def said_elsewhere(error: ArgoError, source: str) -> str:
    """The message of an error about an order, where the command at hand has not the options that
    help, but `argo route` has."""
    ways = [f"argo route {shlex.quote(source)} {_WORDS[remedy]}" for remedy in error.remedies]
    return f"{error} ({', '.join(ways)})" if ways else str(error)


def order_said(text: str) -> str:
    """What is said of an order, with the option that keeps it as it is written."""
    from argo_compiler.reorder.precedences import AS_WRITTEN

    return text.replace(AS_WRITTEN, f"{AS_WRITTEN} (--keep-order)")


def with_options(diagnostics: Iterable["Diagnostic"]) -> tuple["Diagnostic", ...]:
    """Diagnostics whose hints name the options that help."""
    return tuple(d.model_copy(update={"hint": _hint(d)}) if d.remedies else d for d in diagnostics)


def _hint(diagnostic: "Diagnostic") -> str:
    hint, choice = diagnostic.hint or "", diagnostic.choice
    if choice is None or not choice.values:
        return f"{hint}{_ways(diagnostic.remedies)}".lstrip()
    option = _WORDS[choice.remedy]
    chosen = listed([f"{option} {value}" for value in choice.values], "or")
    it = "it " if choice.remedy is Remedy.CHOOSE_SITE else ""
    return hint.replace(str(choice), f"choose {it}with {chosen}")


def _ways(remedies: tuple[Remedy, ...], about: str = "") -> str:
    ways = [_WORDS[remedy].format(about=shlex.quote(about)) for remedy in remedies]
    return f" ({', '.join(ways)})" if ways else ""
