"""Each diagnostic of `check`, on a mission that has one fault only."""

from functools import partial

import pytest
from pydantic import ValidationError

from argo_compiler.base.catalog import Area, Catalog
from argo_compiler.base.model import Pose
from argo_compiler.checks import check
from argo_compiler.diagnostics import Severity, Span
from argo_compiler.il import (
    Action,
    Condition,
    ConditionType,
    EventKind,
    Group,
    JointState,
    Mission,
    Stop,
    Task,
    TimeWindow,
    Transition,
)
from tests.mission_writing import checkpoint, start, wait
from tests.mission_writing import measure as at_its_name
from tests.mission_writing import reaction as react

measure = partial(at_its_name, object_id="1")


def when(target, type=ConditionType.LESS, object_id="1", low=0.0, high=None):
    condition = Condition(type=type, object_id=object_id, param1=low, param2=high)
    return Transition(target=target, conditions=(condition,))


START = start("S", "A")
CHAIN = (measure("A", "B"), measure("B", "C"), measure("C", "D"), measure("D"))


def chain(*groups, tasks=CHAIN):
    return Mission(tasks=tasks, groups=groups)


def group(name, start, end, count=1, **fields):
    return Group(name=name, start=start, end=end, max_repeat_count=count, **fields)


def codes(mission, catalog=None):
    return [finding.code for finding in check(mission, catalog)]


ERRORS = [
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
    ("il.branch-without-target", (measure("A", on_failure="branch"),)),
    ("il.unknown-target", (measure("A", on_failure="branch", failure_target="Z"),)),
    ("il.unknown-target", (measure("A", window=TimeWindow(latest=9, missed_target="Z")),)),
    ("il.window-order", (measure("A", window=TimeWindow(earliest=9, latest=9)),)),
    ("il.condition-bound", (measure("A", "A", when("A", low=None)),)),
    ("il.stale-without-age", (measure("A", "A", when("A", ConditionType.STALE, low=None)),)),
    ("il.joint-states", (measure("A", joint_states=JointState(names=["a"], efforts=[1, 2])),)),
    ("il.joint-states", (measure("A", joint_states=JointState(names=["a"])),)),
]
WARNINGS = [
    ("il.no-unconditional", (measure("A", when("A")),)),
    ("il.start-condition", (Task(name="S", action="START", transitions=[when("A")]), *CHAIN)),
    ("il.never-measured", (measure("A", "A", when("A", object_id="9")),)),
    ("il.many-retries", (measure("A", retries=101),)),
    ("il.unused-field", (measure("A", "A", when("A", high=3.0)),)),
    ("il.unused-field", (Task(name="S", action=Action.START, retries=1),)),
    ("il.unused-field", (Task(name="S", action=Action.START, on_failure="abort"),)),
    ("il.wait-without-limit", (wait("W", event="all_clear"),)),
]


@pytest.mark.parametrize(
    ("severity", "code", "tasks"),
    [
        *((Severity.ERROR, *case) for case in ERRORS),
        *((Severity.WARNING, *case) for case in WARNINGS),
    ],
)
def test_findings_about_tasks(severity, code, tasks):
    (finding,) = check(Mission(tasks=tasks))
    assert (finding.code, finding.severity) == (code, severity)
    assert finding.hint


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
    CATALOG = Catalog(site="test", checkpoints=(checkpoint(1, 0, 10, 2, 4),), areas=(), floors=())

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


DOCK = Pose(x=0, y=0, z=0)
CHARGED = EventKind.BATTERY_CHARGED
GAS, ALARM, HOT_SPOT, LOW, CLEAR, TIME_UP = (
    EventKind.GAS_LEAK,
    EventKind.PLATFORM_ALARM,
    EventKind.HOT_SPOT,
    EventKind.LOW_BATTERY,
    EventKind.ALL_CLEAR,
    EventKind.TIME_UP,
)


class TestReactions:
    @pytest.mark.parametrize(
        ("code", "field", "reactions"),
        [
            ("il.duplicate-reaction", "[1].event", [react(GAS, "pause"), react(GAS, "abort")]),
            ("il.safe-area-without-pose", "['gas_leak'].response", [react(GAS, "safe_area")]),
            ("il.no-dock", "['low_battery'].response", [react(LOW, "return")]),
            ("il.until-itself", "['gas_leak'].until", [react(GAS, "pause", until=GAS)]),
            (
                "il.battery-level",
                "['gas_leak'].battery_below",
                [react(GAS, "pause", battery_below=0.3)],
            ),
            (
                "il.charge-without-wait",
                "['gas_leak'].charge_to",
                [react(GAS, "pause", until=CLEAR, charge_to=0.6)],
            ),
            (
                "il.charge-without-wait",
                "['low_battery'].charge_for",
                [react(LOW, "pause", charge_for=60)],
            ),
            (
                "il.charge-below-level",
                "['low_battery'].charge_to",
                [react(LOW, "pause", until=CHARGED, battery_below=0.3, charge_to=0.3)],
            ),
            (
                "il.charge-after-limit",
                "['low_battery'].charge_for",
                [react(LOW, "pause", until=CHARGED, charge_for=60, hold_limit=60)],
            ),
        ],
    )
    def test_errors(self, code, field, reactions):
        (finding,) = check(Mission(tasks=CHAIN, reactions=reactions))
        assert (finding.code, finding.severity) == (code, Severity.ERROR)
        assert finding.subject == f"reactions{field}"
        assert finding.hint

    @pytest.mark.rule("R11")
    def test_a_level_of_the_battery_is_a_share_of_its_charge(self):
        low = react(LOW, "pause", battery_below=0.3)
        assert check(Mission(tasks=CHAIN, reactions=[low])) == ()
        for level in (0.0, 1.0, -0.1, 30.0):
            with pytest.raises(ValidationError):
                react(LOW, "pause", battery_below=level)

    @pytest.mark.rule("R12")
    def test_a_charge_is_a_share_and_a_time(self):
        low = react(LOW, "pause", until=CHARGED, charge_to=1.0, charge_for=60)
        assert check(Mission(tasks=CHAIN, reactions=[low])) == ()
        for field, value in (("charge_to", 0.0), ("charge_to", 1.1), ("charge_for", 0.0)):
            with pytest.raises(ValidationError):
                react(LOW, "pause", until=CHARGED, **{field: value})

    @pytest.mark.parametrize(
        ("code", "field", "reactions"),
        [
            ("il.unused-field", "pose", [react(GAS, "pause", pose=DOCK)]),
            ("il.unused-field", "pose", [react(GAS, "abort", pose=DOCK)]),
            ("il.unused-field", "until", [react(GAS, "report", until=CLEAR)]),
            ("il.unused-field", "until", [react(GAS, "abort", until=GAS)]),
            ("il.unused-field", "afterwards", [react(GAS, "pause", afterwards="wait")]),
            ("il.unused-field", "afterwards", [react(GAS, "report", afterwards="wait")]),
            ("il.all-clear-elsewhere", "until", [react(GAS, "safe_area", pose=DOCK, until=CLEAR)]),
            ("il.all-clear-elsewhere", "until", [react(GAS, "return", pose=DOCK, until=CLEAR)]),
            ("il.all-clear-not-sensed", "until", [react(HOT_SPOT, "pause", until=CLEAR)]),
            (
                "il.not-lost-before",
                "until",
                [react(LOW, "return", pose=DOCK, until=EventKind.CONNECTION_RESTORED)],
            ),
            ("il.all-clear-not-sensed", "until", [react(LOW, "return", pose=DOCK, until=CLEAR)]),
            ("il.time-up-without-limit", "event", [react(TIME_UP, "report")]),
            ("il.time-up-without-limit", "until", [react(GAS, "pause", until=TIME_UP)]),
            (
                "il.until-answered",
                "until",
                [react(GAS, "pause", until=LOW), react(LOW, "abort", priority=1)],
            ),
        ],
    )
    def test_warnings(self, code, field, reactions):
        (finding,) = check(Mission(tasks=CHAIN, reactions=reactions))
        assert (finding.code, finding.severity) == (code, Severity.WARNING)
        assert finding.subject == f"reactions['{reactions[0].event}'].{field}"

    @pytest.mark.parametrize(
        "reactions",
        [
            [react(GAS, "safe_area", pose=DOCK, until=CLEAR, hold_limit=60, afterwards="resume")],
            [react(ALARM, "safe_area", pose=DOCK, until=CLEAR, afterwards="resume")],
            [react(HOT_SPOT, "pause", until=CLEAR, hold_limit=60)],
            [react(EventKind.CONNECTION_LOST, "pause", until=EventKind.CONNECTION_RESTORED)],
            [react(GAS, "safe_area", pose=DOCK, afterwards="wait")],
            [react(LOW, "return", until=EventKind.BATTERY_CHARGED)],
            [react(GAS, "pause", until=CLEAR), react(CLEAR, "report", priority=9)],
            [react(GAS, "pause", until=CLEAR), react(CLEAR, "pause")],
            [react(GAS, "abort"), react(LOW, "pause")],
            [react(GAS, "pause", afterwards="resume")],
            [react(TIME_UP, "return")],
        ],
    )
    def test_sound_reactions(self, reactions):
        mission = Mission(tasks=CHAIN, reactions=reactions, dock=DOCK, max_duration=60)
        assert codes(mission) == []


@pytest.mark.parametrize("name", ["return to dock", "react to gas_leak"])
def test_names_that_the_machine_needs_are_reserved(name):
    (finding,) = check(chain(tasks=(measure(name),)))
    assert (finding.code, finding.subject) == ("il.reserved-name", f"tasks['{name}'].name")


def test_returning_without_a_dock_is_one_finding():
    tasks = (measure("A", "B", on_failure="return"), measure("B", on_failure="return"))
    (finding,) = check(chain(tasks=tasks))
    assert (finding.code, finding.subject) == ("il.no-dock", "tasks['A'].on_failure")
    assert "1 more" in finding.message
    assert codes(Mission(tasks=tasks, dock=DOCK)) == []


@pytest.mark.parametrize(
    ("low", "high", "inclusive", "sound"),
    [(1, 2, False, True), (2, 2, False, False), (2, 2, True, True), (3, 2, True, False)],
)
def test_bounds_of_within(low, high, inclusive, sound):
    condition = Condition(
        type=ConditionType.WITHIN, object_id="1", param1=low, param2=high, inclusive=inclusive
    )
    way = Transition(target="A", conditions=(condition,))
    found = check(chain(tasks=(measure("A", "A", way),)))
    assert [f.code for f in found] == ([] if sound else ["il.within-bounds"])
    assert all(f.subject == "tasks['A'].transitions[1].conditions[0]" for f in found)


@pytest.mark.parametrize(
    ("names", "positions"), [(("a",), ()), ((), (1.0,)), (("a", "a"), (1.0, 2.0))]
)
def test_joint_states_that_do_not_match(names, positions):
    joints = JointState(names=names, positions=positions)
    assert codes(chain(tasks=(measure("A", joint_states=joints),))) == ["il.joint-states"]
    good = JointState(names=("a", "b"), positions=(1.0, 1.0))
    assert codes(chain(tasks=(measure("A", joint_states=good),))) == []


def test_interruptions_count_only_with_a_duration():
    (finding,) = check(chain(group("G", "A", "B", count_interruptions=True)))
    assert (finding.code, finding.severity) == ("il.unused-field", Severity.WARNING)
    timed = group("G", "A", "B", count_interruptions=True, max_repeat_duration=9)
    assert codes(chain(timed)) == []


def test_a_name_that_is_nearly_right_is_named():
    tasks = (measure("MEASURE 1", "MESURE 2"), measure("MEASURE 2"))
    target, start = check(chain(group("G", "MEASURE 1", "MEASUR 2"), tasks=tasks))
    assert "'MEASURE 2'" in target.hint
    assert target.subject == "tasks['MEASURE 1'].transitions[0].target"
    assert "'MEASURE 2'" in start.hint
    assert start.subject == "groups['G'].end"


def test_the_current_task_has_to_exist():
    mission = Mission(tasks=CHAIN, current="Z")
    assert codes(mission) == ["il.unknown-current"]
    assert codes(mission.model_copy(update={"current": "A"})) == []


@pytest.mark.rule("M8")
def test_what_was_left_out_is_said_until_it_is_back():
    mission = Mission(tasks=CHAIN, left_out=("Z", CHAIN[0].name, "Y"))
    (finding,) = check(mission)
    assert (finding.code, finding.subject) == ("il.left-out", "left_out")
    assert finding.message == "left out when the order was chosen: Z, Y"
    many = mission.model_copy(update={"left_out": tuple(f"T{k}" for k in range(30))})
    assert check(many)[0].message.endswith("T11 and 18 more")
    assert codes(mission.model_copy(update={"left_out": ()})) == []


class TestSite:
    CATALOG = TestCatalog.CATALOG.model_copy(update={"areas": (Area(number=2, dock=DOCK),)})

    def test_areas_that_the_site_lacks(self):
        mission = Mission(tasks=CHAIN, start_area=2, end_area=3)
        (finding,) = check(mission, self.CATALOG)
        assert (finding.code, finding.subject) == ("il.unknown-area", "end_area")
        assert finding.hint.endswith(" 2")
        assert check(mission) == ()

    def test_a_mission_of_another_site_is_not_looked_up(self):
        task = measure("A", object_id="77")
        mission = Mission(tasks=(task,), site="elsewhere", end_area=9)
        assert codes(mission, self.CATALOG) == ["il.other-site"]
        here = mission.model_copy(update={"site": "test"})
        assert codes(here, self.CATALOG) == ["il.unknown-object", "il.unknown-area"]
