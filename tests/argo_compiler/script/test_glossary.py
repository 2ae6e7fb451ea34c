"""Short forms: plant tags and abbreviations stand for what the script or the site says."""

import pytest

from argo_compiler.base.catalog import Catalog
from argo_compiler.script import LineState
from tests.argo_compiler.script.conftest import draft_of, measured_in


def tagged(catalog: Catalog, **tags: int) -> Catalog:
    """Return the catalogue with plant tags; underscores of a name stand for `-`."""
    by_id = {id: (name.lstrip("_").replace("_", "-"),) for name, id in tags.items()}
    checkpoints = (c.model_copy(update={"tags": by_id.get(c.id, ())}) for c in catalog.checkpoints)
    return catalog.model_copy(update={"checkpoints": tuple(checkpoints)})


@pytest.mark.parametrize(
    "text",
    [
        "PG = pressure gauge, LG = liquid level gauge\nPG 5\nLG 2",
        "Abbreviations\nPG: pressure gauge\nLG: liquid level gauge\n\n- PG5\n- LG-2",
        "DG = Manometer; FA = Füllstandsanzeige\nPrüfe DG 5 und FA 2.",
        "Check P1 and then L2.\nP1 = pressure gauge 5\nL2 = checkpoint 7",
        "Key:\nPI-1034A    pressure gauge 5\nLI-1102     liquid level gauge 2\n\n"
        "Check PI 1034 A. Check LI1102.",
        "PT-01 = pressure gauge 5, LT-02 = liquid level gauge 2\nRead gauges PT_01 and LT 02.",
    ],
)
def test_a_script_explains_its_short_forms(text: str, catalog: Catalog) -> None:
    draft = draft_of(text, catalog)
    assert measured_in(draft.require_mission()) == ["8", "7"]


@pytest.mark.parametrize(
    "said", ["20-PI-1034A", "20-PI-1034 A", "PI 1034A", "PI_1034_A", "PI1034A", "valve PI-1034A"]
)
def test_a_tag_of_the_site_is_known_in_any_spacing(said: str, catalog: Catalog) -> None:
    draft = draft_of(f"Check {said}.", tagged(catalog, _20_PI_1034A=4))
    assert measured_in(draft.require_mission()) == ["4"]


@pytest.mark.parametrize("said", ["PI-1034", "PI-1034B", "21-PI-1034A", "pressure gauge PI-1034A"])
def test_a_tag_that_the_site_does_not_have_is_open(said: str, catalog: Catalog) -> None:
    draft = draft_of(f"Check #1. Check {said}.", tagged(catalog, _20_PI_1034A=4))
    assert draft.mission is None
    assert [line.state for line in draft.left] == [LineState.OPEN]


def test_a_tag_with_two_meanings_is_open(catalog: Catalog) -> None:
    site = tagged(catalog, _20_PI_1034=4, _21_PI_1034=5)
    assert draft_of("Check PI-1034.", site).mission is None
    assert measured_in(draft_of("Check 21-PI-1034.", site).require_mission()) == ["5"]


def test_a_row_that_may_explain_a_tag_or_be_a_task_is_asked_about(catalog: Catalog) -> None:
    text = "PI-1034    pressure gauge 5\nPI-1035    valve R25\n\nCheck PI-1035."
    draft = draft_of(text, catalog)
    assert [line.line for line in draft.left] == [2]
    assert ("Check checkpoint 4.",) in draft.left[0].choices


def test_short_forms_of_other_things_are_left(catalog: Catalog) -> None:
    draft = draft_of("VIP = very important person\nCheck #1.", catalog)
    assert [line.state for line in draft.left] in ([], [LineState.OPEN])
