"""Writes a mission as a script, in the canonical form.

What the script language means if nothing is said is left out, and places, areas and patrols stand
as a person would write them; the rest stands in the exact forms. Reading the script gives the
mission again, so that formatting it once more changes nothing.
"""

from argo_compiler.base.catalog import Catalog
from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.diagnostics.subject import subject_of
from argo_compiler.il import Mission
from argo_compiler.script.write.header import header_lines
from argo_compiler.script.write.places import Places
from argo_compiler.script.write.reactions import reaction_said
from argo_compiler.script.write.steps import Said, unwritable, write_steps
from argo_compiler.script.write.text import UnwritableError, capital, paragraph, wrapped


def format_script(mission: Mission, catalog: Catalog) -> str:
    """The mission as a script that `import_script` reads back to the same mission.

    The mission is one that `check` finds no error in. Raises DiagnosticError if the script
    language can't say it: the diagnostics name the tasks, and what of them.
    """
    header, steps, reactions = parts_said(mission, catalog)
    lines = [line for field in header for line in wrapped(field)]
    parts = [lines, lines_of(steps), lines_of(reactions)]
    return "\n\n".join("\n".join(part) for part in parts if part) + "\n"


def lines_of(said: list[Said]) -> list[str]:
    """The lines of steps or of other sentences."""
    lines: list[str] = []
    for one in said:
        opening = "" if one.number is None else f"{one.number}. "
        lines += paragraph(opening, one.sentences)
    return lines


def parts_said(mission: Mission, catalog: Catalog) -> tuple[list[str], list[Said], list[Said]]:
    """What is said in the header, of the steps and of the reactions; raises as `format_script`."""
    places = Places(catalog)
    steps = write_steps(mission, catalog, places)
    diagnostics = list(steps.diagnostics)
    reactions: list[Said] = []
    for reaction in mission.reactions:
        subject = subject_of("reactions", reaction.event)
        try:
            sentence = capital(reaction_said(reaction, places))
        except UnwritableError as error:
            what = f"the reaction to {reaction.event}"
            diagnostics.append(unwritable(what, subject, reaction.source, error))
        else:
            reactions.append(Said(subject, (sentence,), source=reaction.source))
    if diagnostics:
        raise DiagnosticError("mission", diagnostics)
    return header_lines(mission, catalog, steps), steps.said, [*steps.orders, *reactions]
