"""Error messages with the options and commands that help, as the libraries know no options."""

import shlex
from collections.abc import Iterable
from typing import TYPE_CHECKING

from argo_compiler.base.errors import ArgoError, Remedy
from argo_compiler.base.listing import listed
from argo_compiler.base.message import as_message
from argo_planner.terminal.language import in_chosen_language

if TYPE_CHECKING:
    from argo_compiler.diagnostics import Diagnostic

_REMEDY_TEXTS = {
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
    Remedy.TRUST: "--trust",
}


def error_text(error: ArgoError, prefix: str = "") -> str:
    """Return the message of an error, with the options and commands that help.

    The `prefix` goes before a message that does not begin with the name of a file.
    """
    # Slow to import, and most commands have no error.
    from argo_compiler.diagnostics import DiagnosticError

    if isinstance(error, DiagnosticError):
        return diagnostics_text(error.diagnostics, error.source_name)
    remedies = _remedies_text(error.remedies, error.about)
    message = in_chosen_language(str(error))
    return f"{prefix}{message} ({remedies})" if remedies else f"{prefix}{message}"


def diagnostics_text(diagnostics: Iterable["Diagnostic"], source: str) -> str:
    """Return the text of the diagnostics of a file, with the options that are the remedies."""
    from argo_compiler.diagnostics import to_text

    return to_text(add_options_to_hints(diagnostics, source), source, in_chosen_language)


def error_text_with_route_commands(error: ArgoError, source: str) -> str:
    """Return the message of an error, followed by `argo route` commands with its remedies.

    It is for commands that search for an order, but lack the options of `argo route` that are the
    remedies. `source` is the file of the mission.
    """
    commands = [
        f"argo route {shlex.quote(source)} {_REMEDY_TEXTS[remedy]}" for remedy in error.remedies
    ]
    return f"{error} ({', '.join(commands)})" if commands else str(error)


def insert_keep_order_option(text: str) -> str:
    """Return the text with `(--keep-order)` after each mention of the written order."""
    from argo_compiler.reorder.precedences import AS_WRITTEN

    return text.replace(AS_WRITTEN, f"{AS_WRITTEN} (--keep-order)")


def add_options_to_hints(
    diagnostics: Iterable["Diagnostic"], source: str
) -> tuple["Diagnostic", ...]:
    """Return all diagnostics, with the options that are the remedy added to their hints.

    `source` is the file that they are about.
    """
    return tuple(
        d.model_copy(update={"hint": _hint(d, source)}) if d.remedies else d for d in diagnostics
    )


def _hint(diagnostic: "Diagnostic", source: str) -> str:
    hint, choice = as_message(diagnostic.hint or ""), diagnostic.choice
    if choice is None or not choice.values:
        remedies = _remedies_text(diagnostic.remedies, source)
        return hint + f" ({remedies})" if hint else remedies
    option = _REMEDY_TEXTS[choice.remedy]
    chosen = listed([f"{option} {value}" for value in choice.values], "or")
    it = "it " if choice.remedy is Remedy.CHOOSE_SITE else ""
    return hint.replace(str(choice), f"choose {it}with {chosen}")


def _remedies_text(remedies: tuple[Remedy, ...], about: str) -> str:
    return ", ".join(_REMEDY_TEXTS[remedy].format(about=shlex.quote(about)) for remedy in remedies)
