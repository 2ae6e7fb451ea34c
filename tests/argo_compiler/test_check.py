"""Every finding of `check`, on a mission that is sound but for one thing."""

import pytest

from argo_compiler.catalog import Catalog, CheckpointInfo, CheckpointKind, Interval
from argo_compiler.check import check
from argo_compiler.diagnostics import Severity, Span
from argo_compiler.il import (
    Action,
    Condition,
    ConditionType,
    Group,
    Mission,
    Stop,
    Task,
    Transition,
)
from argo_compiler.model import Pose


def measure(name, *ways, object_id="1", **fields):
    """A MEASURE task. A way is the name of the next task, or a whole transition."""
    transitions = tuple(Transition(target=w) if isinstance(w, str) else w for w in ways)
    return Task(
        name=name, action=Action.MEASURE, object_id=object_id, transitions=transitions, **fields
    )


def when(target, type=ConditionType.LESS, object_id="1", low=0.0, high=None):
    condition = Condition(type=type, object_id=object_id, param1=low, param2=high)
    return Transition(target=target, conditions=(condition,))


START = Task(name="S", action=Action.START, transitions=(Transition(target="A"),))
CHAIN = (measure("A", "B"), measure("B", "C"), measure("C", "D"), measure("D"))


def chain(*groups, tasks=CHAIN):
    return Mission(tasks=tasks, groups=groups)


def group(name, start, end, count=1, **fields):
    return Group(name=name, start=start, end=end, max_repeat_count=count, **fields)


def codes(mission, catalog=None):
    return [finding.code for finding in check(mission, catalog)]


@pytest.mark.parametrize(
    ("code", "tasks"),
    [
        ("il.empty-mission", ()),
        ("il.duplicate-task", (measure("A"), measure("A"))),
        ("il.unknown-target", (measure("A", "Z"),)),
        ("il.many-unconditional", (measure("A", "A", "A"),)),
        ("il.measure-without-object", (measure("A", object_id=None),)),
        ("il.waypoint-without-pose", (Task(name="W", action=Action.WAYPOINT),)),
        ("il.many-starts", (START, START.model_copy(update={"name": "S2"}), measure("A"))),
        ("il.start-as-target", (START, measure("A", "S"))),
        ("il.within-bounds", (measure("A", "A", when("A", ConditionType.WITHIN)),)),
        ("il.within-bounds", (measure("A", "A", when("A", ConditionType.WITHIN, low=2, high=2)),)),
    ],
)
def test_errors_of_tasks(code, tasks):
    (finding,) = check(Mission(tasks=tasks))
    assert (finding.code, finding.severity) == (code, Severity.ERROR)
    assert finding.hint


@pytest.mark.parametrize(
    ("code", "tasks"),
    [
        ("il.no-unconditional", (measure("A", when("A")),)),
        ("il.start-condition", (Task(name="S", action="START", transitions=[when("A")]), *CHAIN)),
        ("il.never-measured", (measure("A", "A", when("A", object_id="9")),)),
    ],
)
def test_warnings_of_tasks(code, tasks):
    (finding,) = check(Mission(tasks=tasks))
    assert (finding.code, finding.severity) == (code, Severity.WARNING)


@pytest.mark.parametrize(
    ("code", "groups"),
    [
        ("il.duplicate-group", [group("G", "A", "A"), group("G", "B", "B")]),
        ("il.group-name", [group("G", "A", "B"), group("G/", "A", "A")]),
        ("il.group-parent", [group("G/H", "A", "B")]),
        ("il.unknown-group-task", [group("G", "Z", "A")]),
        ("il.unknown-group-task", [group("G", "Z", "Z")]),
        ("il.group-order", [group("G", "B", "A")]),
        ("il.group-outside-parent", [group("G", "A", "B"), group("G/H", "B", "C")]),
        ("il.group-outside-parent", [group("G", "A", "B"), group("G/H", "C", "C")]),
        ("il.group-overlap", [group("G", "A", "B"), group("H", "B", "C")]),
        ("il.group-overlap", [group("G", "A", "C"), group("H", "B", "B")]),
        (
            "il.group-overlap",
            [group("G", "A", "D"), group("G/H", "A", "B"), group("G/I", "B", "C")],
        ),
        ("il.group-same-range", [group("G", "A", "B"), group("H", "A", "B")]),
        ("il.group-duration", [group("G", "A", "B", max_repeat_duration=1e-9)]),
        ("il.endless-group", [group("G", "A", "B", count=0)]),
    ],
)
def test_errors_of_groups(code, groups):
    (finding,) = check(chain(*groups))
    assert (finding.code, finding.severity) == (code, Severity.ERROR)
    assert groups[-1].name in finding.message
    assert finding.hint


def test_start_in_a_group():
    assert codes(chain(group("G", "S", "A"), tasks=(START, *CHAIN))) == ["il.start-in-group"]


@pytest.mark.parametrize(
    "groups",
    [
        [group("G", "A", "B"), group("H", "C", "C")],
        [group("G/H", "A", "B"), group("G", "A", "B")],
        [group("G", "A", "D"), group("G/H", "A", "B"), group("G/I", "C", "D")],
        [group("G", "A", "B", count=0, max_repeat_duration=9)],
        [group("G", "A", "B", count=0, max_repeat_duration=1e-9, stop=Stop.SOFT)],
    ],
)
def test_sound_groups(groups):
    assert codes(chain(*groups)) == []


class TestEndlessGroup:
    ENDLESS = group("G", "A", "B", count=0)

    @pytest.mark.parametrize(
        "tasks",
        [
            (measure("A", "B"), measure("B", "C", when("C")), measure("C")),
            (measure("A", "C"), measure("B", "C"), measure("C")),
            (measure("A"), measure("B", "C"), measure("C")),
            (measure("A", when("B")), measure("B", "A")),
        ],
        ids=["condition of the end", "unconditional inside", "end of mission", "no condition"],
    )
    def test_with_a_way_out(self, tasks):
        assert "il.endless-group" not in codes(chain(self.ENDLESS, tasks=tasks))

    def test_jump_inside_is_no_way_out(self):
        tasks = (measure("A", "B", when("B")), measure("B", "C", when("A")), measure("C"))
        assert codes(chain(self.ENDLESS, tasks=tasks)) == ["il.endless-group"]

    def test_time_of_a_group_around_bounds_it(self):
        inner = group("G/H", "A", "A", count=0)
        around = group("G", "A", "B", count=0, max_repeat_duration=9)
        assert codes(chain(inner, around)) == []
        soft = around.model_copy(update={"stop": Stop.SOFT})
        assert codes(chain(inner, soft)) == ["il.endless-group"]

    def test_time_out_inside_leads_out_of_the_group_around(self):
        groups = [
            group("G", "A", "C", count=0),
            group("G/H", "A", "B", count=0, max_repeat_duration=9),
            group("G/H/I", "B", "B", count=0),
        ]
        tasks = (measure("A", "B"), measure("B", "D"), measure("C", "A"), measure("D"))
        assert codes(chain(*groups, tasks=tasks)) == []


class TestCatalog:
    CATALOG = Catalog(
        site="test",
        checkpoints=(
            CheckpointInfo(
                id=1,
                kind=CheckpointKind.PRESSURE_GAUGE,
                name="pressure gauge 1",
                floor=1,
                unit="bar",
                range=Interval(low=0, high=10),
                nominal=Interval(low=2, high=4),
            ),
        ),
        areas=(),
        floors=(),
    )

    def test_known_checkpoint(self):
        assert codes(chain(), self.CATALOG) == []

    def test_unknown_checkpoint_of_a_task_and_of_a_condition(self):
        task = measure("A", "A", when("A", object_id="9"), object_id="8")
        findings = check(chain(tasks=(task,)), self.CATALOG)
        assert [finding.code for finding in findings] == ["il.unknown-object"] * 2
        assert "'8'" in findings[0].message
        assert "'9'" in findings[1].message


def test_findings_point_at_the_script():
    here = Span(line=7, column=3, length=4)
    (of_task,) = check(chain(tasks=(measure("A", "Z", source=here),)))
    (of_group,) = check(chain(group("G", "Z", "A", source=here)))
    assert of_task.span == of_group.span == here


def test_all_findings_come_at_once():
    tasks = (measure("A", "Z"), Task(name="W", action="WAYPOINT"), measure("A"))
    assert codes(chain(group("G", "Q", "A"), tasks=tasks)) == [
        "il.duplicate-task",
        "il.unknown-target",
        "il.waypoint-without-pose",
        "il.unknown-group-task",
    ]


def test_sound_mission_has_no_findings():
    way = Task(name="W", action=Action.WAYPOINT, pose=Pose(x=0, y=0, z=0))
    assert codes(chain(tasks=(START, *CHAIN, way))) == []
