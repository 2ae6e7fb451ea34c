"""A made-up site with the checkpoints of the competition's kind, and where the scripts lie."""

import os
from collections.abc import Callable, Iterable
from pathlib import Path

import pytest

from argo_compiler.base.catalog import (
    Area,
    Catalog,
    CheckpointInfo,
    CheckpointKind,
    Floor,
    Interval,
    Place,
)
from argo_compiler.base.model import Pose
from argo_compiler.diagnostics import Diagnostic, DiagnosticError, Severity
from argo_compiler.il import Mission
from argo_compiler.script import Draft, LineDecision, Resolved, import_script
from tests.mission_writing import unplaced
from tests.whole_scripts import import_whole

NAMES = {
    1: ["pressure gauge 1", "liquid level gauge 1", "pressure gauge 2", "valve R25"],
    2: ["valve R12", "pressure gauge 3", "liquid level gauge 2", "pressure gauge 5"],
    3: ["pressure gauge 4", "valve R31", "valve R7", "liquid level gauge 3"],
    4: ["pressure gauge 6", "valve R18", "pressure gauge 7"],
    5: ["liquid level gauge 4", "valve R40", "pressure gauge 8"],
    6: ["valve R9", "liquid level gauge 5"],
}
SCALES = {
    CheckpointKind.PRESSURE_GAUGE: ("bar", Interval(low=0, high=10), Interval(low=3, high=7)),
    CheckpointKind.LIQUID_LEVEL_GAUGE: ("%", Interval(low=0, high=100), Interval(low=20, high=80)),
    CheckpointKind.VALVE: ("deg", Interval(low=0, high=90), Interval(low=0, high=10)),
}
STOREY = 2.5


def _checkpoint(id: int, name: str, floor: int) -> CheckpointInfo:
    kind = CheckpointKind(name.rpartition(" ")[0])
    unit, range_, nominal = SCALES[kind]
    return CheckpointInfo(
        id=id, kind=kind, name=name, floor=floor, unit=unit, range=range_, nominal=nominal
    )


def _floor(number: int) -> Floor:
    z = (number - 1) * STOREY
    corners = [(1, 1), (11, 1), (11, 7), (1, 7)]
    return Floor(number=number, z=z, patrol=tuple(Pose(x=x, y=y, z=z) for x, y in corners))


def make_catalog() -> Catalog:
    named = [(name, floor) for floor, names in NAMES.items() for name in names]
    return Catalog(
        site="umad",
        checkpoints=tuple(_checkpoint(i, n, f) for i, (n, f) in enumerate(named, start=1)),
        areas=(
            Area(number=1, dock=Pose(x=-4, y=2, z=0)),
            Area(number=2, dock=Pose(x=-4, y=6, z=0, yaw=1.5)),
        ),
        floors=tuple(_floor(number) for number in NAMES),
        places=(Place(name="front of the site", pose=Pose(x=-1, y=4, z=0)),),
    )


CATALOG = make_catalog()


def draft_of(
    text: str, catalog: Catalog = CATALOG, decisions: Iterable[LineDecision] = ()
) -> Draft:
    """Return the draft of a script for starting area 1."""
    return import_script(text, catalog, start_area=1, decisions=decisions)


def findings(text: str, catalog: Catalog, **areas: int) -> tuple[Diagnostic, ...]:
    """Return the diagnostics of a script, be it a mission or refused."""
    try:
        result: Resolved | DiagnosticError = import_whole(text, catalog, **areas)
    except DiagnosticError as error:
        result = error
    return result.diagnostics


def refusals(text: str, catalog: Catalog) -> list[Diagnostic]:
    """Return the errors for which a script is refused."""
    with pytest.raises(DiagnosticError) as caught:
        import_whole(text, catalog)
    return [d for d in caught.value.diagnostics if d.severity is Severity.ERROR]


def only(text: str, catalog: Catalog, **areas: int) -> tuple[str, int, int, int]:
    """Return the code, line, column and length of the only diagnostic."""
    (finding,) = findings(text, catalog, **areas)
    assert finding.span is not None
    assert finding.excerpt == text.split("\n")[finding.span.line - 1]
    return finding.code, finding.span.line, finding.span.column, finding.span.length


def measured_in(mission: Mission) -> list[str]:
    """Return the checkpoints that a mission measures, in the order of its tasks."""
    return [task.object_id for task in mission.tasks if task.object_id is not None]


def measured(text: str, catalog: Catalog) -> list[str]:
    return measured_in(import_whole(text, catalog).mission)


Pairs = list[tuple[str, str]]


def filled(frames: dict[tuple[str, str], Pairs]) -> Pairs:
    """Return pairs of sentences that share words with others: frames, each with what fills it."""
    return [(a.format(x), b.format(y)) for (a, b), rows in frames.items() for x, y in rows]


@pytest.fixture(scope="session")
def meaning_of() -> Callable[[str], object]:
    """What a script means: its mission, whatever its words and places."""
    return lambda text: unplaced(import_whole(text, CATALOG).mission)


@pytest.fixture(scope="session")
def catalog() -> Catalog:
    return CATALOG


@pytest.fixture(scope="session")
def missions() -> Path:
    """The scripts that the project ships."""
    return Path(__file__).parents[3] / "scenarios" / "umad" / "missions"


@pytest.fixture(scope="session")
def originals() -> Path:
    """The competition's sheet and the thesis' protocol, which the project does not ship."""
    folder = os.environ.get("ARGO_ORIGINALS")
    if not folder:
        pytest.skip("ARGO_ORIGINALS names no folder: the two original scripts are not tried")
    return Path(folder)
