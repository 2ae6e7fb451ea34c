"""Open lines that name nothing of a mission: which may be set aside together."""

import pytest

from argo_compiler.base.catalog import Catalog
from argo_compiler.script import import_script
from argo_compiler.script.drafts.naming_nothing import lines_naming_nothing


def labels(text: str, catalog: Catalog) -> list[str]:
    return [line.label for line in lines_naming_nothing(import_script(text, catalog), catalog)]


@pytest.mark.parametrize(
    "line",
    [
        "Photograph the pump",
        "Bring the blue toolbox",
        "[ ] Handrails secure, chains hooked in",
        "Fotografiere die Pumpe",
        "Bring den blauen Werkzeugkasten",
    ],
)
def test_a_line_without_anything_of_a_mission_is_named(line: str, catalog: Catalog) -> None:
    text = f"Start in starting area 1.\n{line}\nCheck checkpoint 4.\n"
    assert labels(text, catalog) == ["2"]


@pytest.mark.parametrize(
    "line",
    [
        "Photograph pump 3",  # a figure
        "Photograph the valve",  # a kind of checkpoint
        "Photograph the pump on the first floor",
        "Photograph the pump for ten minutes",
        "Do not photograph the pump",
        "Photograph the pump unless Karl objects",
        "Photograph the pump if it is raining",
        "Then photograph the pump",
        "Photograph the pump first",
        "Photograph the pump again",
        "Photograph the pump only",
        "Same for the pump, likewise",
        "Belay that",  # points to what stands above
        "Photograph these:",  # may be about what stands below
        "Should it photograph the pump?",
        "Photograph the gague",  # nearly a word of the language
        "Photograph the pump. Bring the toolbox.",  # parts of a line belong together
        "[x] Handrails secure",
        "Fotografiere die Pumpe nicht",
        "Fotografiere die Pumpe, sofern Karl zustimmt",
    ],
)
def test_a_line_that_may_have_an_effect_is_not_named(line: str, catalog: Catalog) -> None:
    text = f"Start in starting area 1.\n{line}\nCheck checkpoint 4.\n"
    draft = import_script(text, catalog)
    assert lines_naming_nothing(draft, catalog) == ()


def test_decided_and_proposed_lines_are_not_named(catalog: Catalog) -> None:
    text = "Photograph the pump\nBring the blue toolbox\nI'd like to have valve R25.\n"
    text = f"Start in starting area 1.\n{text}Check checkpoint 5.\n"
    draft = import_script(text, catalog)
    found = lines_naming_nothing(draft, catalog)
    assert [line.label for line in found] == ["2", "3"]
    decided = import_script(text, catalog, decisions=draft.set_aside(["2"]))
    assert [line.label for line in lines_naming_nothing(decided, catalog)] == ["3"]
    nothing_open = import_script(text, catalog, decisions=draft.set_aside(["2", "3"]))
    assert lines_naming_nothing(nothing_open, catalog) == ()


def test_setting_them_aside_changes_nothing_else(catalog: Catalog) -> None:
    """The mission is that of the script without these lines."""
    idle = ("Photograph the pump", "Bring the blue toolbox")
    steps = ("Start in starting area 1.", "Check checkpoint 5.", "Check valve R12.")
    text = "\n".join([steps[0], idle[0], steps[1], idle[1], steps[2]])
    draft = import_script(text, catalog)
    found = [line.label for line in lines_naming_nothing(draft, catalog)]
    assert found == ["2", "4"]
    mission = import_script(text, catalog, decisions=draft.set_aside(found)).require_mission()
    alone = import_script("\n".join(steps), catalog).require_mission()
    plain = [task.model_dump(exclude={"source"}) for task in mission.tasks]
    assert plain == [task.model_dump(exclude={"source"}) for task in alone.tasks]
