"""Faults are loaded from files, completed by the seed, and applied to the site and the run."""

import json
import math
import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from jsonschema import Draft202012Validator
from pydantic import ValidationError
from pydantic_core import PydanticUndefined

from argo_compiler.base.errors import ArgoError
from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.il import EventKind
from argo_compiler.schemas.generate import model_schema
from argo_env.drives.battery import Battery
from argo_env.drives.powertrain import Powertrain
from argo_env.drives.timed_drive import RouteDrive
from argo_env.faults.fault import Fault
from argo_env.faults.kinds import KINDS, FaultFile, resolve_faults, site_with_faults
from argo_env.faults.loading import decode_faults, read_faults
from argo_env.faults.schedule import FaultSchedule
from argo_env.faults.targets import FaultTargets
from argo_env.files import resources
from argo_env.robot.pose import BodyPose
from argo_env.run.spec import RunSpec
from argo_env.sensing.ideal import IdealSensor
from argo_env.sensing.onboard import SensorWithFaults
from argo_env.site.shapes import Box, Role
from argo_env.surroundings import Surroundings
from argo_env.surroundings.surroundings import RadioNetwork
from argo_env.world.without_physics import WorldWithoutPhysics
from argo_env.world.world import World
from tests.conftest import examples
from tests.yard import faults_of, gauged, measure, mission, site_of

SCENARIOS = sorted((resources.scenarios_folder() / "umad" / "faults").glob("*.yaml"))


def write_faults(tmp_path, text):
    path = tmp_path / "faults.yaml"
    path.write_text(text, encoding="utf-8")
    return path


class TestFiles:
    @pytest.mark.parametrize("path", SCENARIOS, ids=lambda p: p.stem)
    def test_the_shipped_files_are_valid_and_fit_their_site(self, path, umad):
        faults = read_faults(path)
        assert path.stem in {f.kind for f in faults}
        resolve_faults(faults, umad, 1)

    @pytest.mark.parametrize(
        ("text", "line", "says"),
        [
            ("faults:\n  - {kind: gas_leek, at: 5}\n", 2, "no kind `gas_leek`"),
            ("faults:\n  - {at: 5}\n", 2, "it has no `kind`"),
            ("faults:\n  - kind: gas_leak\n    rat: 1\n", 3, "is `rate` meant?"),
            ("faults:\n  - kind: gas_leak\n    rate: -1\n", 3, "faults[0].rate"),
            ("faults:\n  - kind: brick\n    at: 3\n", 3, "have no such field"),
            ("faults:\n  - kind: gas_leak\n    at: 9\n    until: 5\n", 2, "it must end later"),
            ("faults:\n  - kind: gas_leak\n    at: 5\n    until: 5\n", 2, "it must end later"),
            ("faults:\n  - kind: brick\n    floor: 1\n    floor: 2\n", 4, "given at line 3"),
            ("faults:\n  - kind: low_battery\n    charge: .nan\n", 3, "charge"),
            (
                "faults:\n  - kind: displaced_checkpoint\n    offset: [0.1, 0.1, 0]\n",
                2,
                "may be at most 0.1 m",
            ),
            ("faults: [\n", 2, "is not YAML"),
            ("- kind: gas_leak\n", 1, "begin with `faults:` and a list below it"),
            ("faults:\n", 1, "begin with `faults:` and a list below it"),
            ("{}\n", 1, "begin with `faults:` and a list below it"),
            ("faults:\n  - kind: gas_leak\n    at: soon\n", 3, "`at` has to be a number"),
            ("faults:\n  - kind: gas_leak\n    at: -1\n", 3, "`at` has to be at least 0"),
            ("faults:\n  - kind: gas_leak\n    place: [1, 2]\n", 3, "`place[2]` is missing"),
            ("faults:\n  - kind: hot_spot\n    radius: 3\n", 3, "`radius` has to be at most 1"),
            ("faults:\n  - kind: brick\n    size: [0.1, 0, 1]\n", 3, "has to be more than 0"),
            ("faults:\n  - kind: brick\n    size: [0.2, 50, 1]\n", 3, "has to be at most 1.5"),
            ("faults:\n  - kind: brick\n    at: 3\n", 3, "is there from the start"),
        ],
    )
    def test_errors_name_the_line(self, tmp_path, text, line, says):
        with pytest.raises(DiagnosticError) as caught:
            read_faults(write_faults(tmp_path, text))
        diagnostic = caught.value.diagnostics[0]
        assert diagnostic.span.line == line
        assert says in f"{diagnostic.message} {diagnostic.hint}"
        assert diagnostic.code.startswith("faults.")

    def test_a_missing_and_an_empty_file_are_refused(self, tmp_path):
        with pytest.raises(ArgoError, match="can't be read"):
            read_faults(tmp_path / "absent.yaml")
        with pytest.raises(DiagnosticError) as caught:
            read_faults(write_faults(tmp_path, "# none\n"))
        assert caught.value.diagnostics[0].hint == "begin with `faults:` and a list below it"

    def test_the_schema_agrees(self):
        schema = json.loads(model_schema(FaultFile, "faults"))
        validator = Draft202012Validator(schema)
        for path in SCENARIOS:
            data = FaultFile(faults=read_faults(path)).model_dump(mode="json")
            validator.validate(data)
        assert not validator.is_valid({"faults": [{"kind": "brick", "at": 3}]})

    def test_the_schema_describes_each_field(self):
        schema = json.loads(model_schema(FaultFile, "faults"))
        for model in (schema, *(d for d in schema["$defs"].values() if "properties" in d)):
            for name, field in model["properties"].items():
                assert name == "kind" or field["description"], f"{model['title']}.{name}"
        moved = schema["$defs"]["DisplacedCheckpoint"]["properties"]
        assert moved["at"]["description"].startswith("s, when it is moved")
        assert moved["until"]["description"] == "s, when it ends; None: it never ends"

    @pytest.mark.parametrize(
        ("data", "says"),
        [
            ({"kind": "abnormal_value", "checkpoint": 99}, "no checkpoint 99"),
            ({"kind": "abnormal_value", "checkpoint": 1, "value": 4.0}, "is not abnormal"),
            ({"kind": "abnormal_value", "checkpoint": 1, "value": 40.0}, "0 to 10 bar"),
            ({"kind": "abnormal_pump", "pump": "pump P-999"}, "no pump `pump P-999`"),
            ({"kind": "brick", "floor": 9}, "no floor 9"),
            ({"kind": "brick", "place": [1, 1]}, "give the `floor`"),
            ({"kind": "brick", "floor": 2, "place": [4.2, 7.7]}, "no walkway"),
            ({"kind": "missing_plate", "floor": 1}, "slab on the ground"),
            ({"kind": "missing_plate", "floor": 2, "rect": [4, 7, 4.5, 8]}, "no deck at"),
            ({"kind": "blocked_stairs", "tower": "tower"}, "west tower, east tower"),
            ({"kind": "blocked_stairs", "floor": 6}, "no stairs up from floor 6"),
            ({"kind": "connection_loss", "floor": 7}, "no floor 7"),
            ({"kind": "gas_leak", "place": [99, 0, 1]}, "no equipment at (99, 0, 1)"),
            ({"kind": "gas_leak", "place": [0, 0, -9]}, "no equipment at"),
            ({"kind": "hot_spot", "place": [0, 0, 30]}, "and (23, 20, 22.5)"),
        ],
    )
    def test_faults_that_do_not_fit_the_site_are_refused(self, umad, data, says):
        brick = {"kind": "brick"}
        with pytest.raises(ArgoError, match=r"^faults\[1\] \(" + data["kind"]) as caught:
            resolve_faults(faults_of(brick, data), umad, 1)
        assert says in str(caught.value)

    def test_faults_that_do_not_fit_the_site_are_reported_with_the_line(self, tmp_path, umad):
        text = "faults:\n  - kind: brick\n    floor: 9\n  - kind: brick\n\n"
        path = write_faults(tmp_path, text + "  - {kind: brick, floor: 8}\n")
        with pytest.raises(DiagnosticError) as caught:
            decode_faults(path.read_bytes(), str(path)).require_fit(umad, 1)
        assert f"{path}:2:5: error: faults[0] (brick): site umad has no floor 9" in str(
            caught.value
        )
        assert [d.span.line for d in caught.value.diagnostics] == [2, 6]
        path.write_text("faults: [{kind: brick}]", encoding="utf-8")
        decode_faults(path.read_bytes(), str(path)).require_fit(umad, 1)

    def test_no_brick_lies_over_a_dock(self):
        """The robot of this site is docked on the slab."""
        site = site_of()
        dock = site.docks[1]
        for away, size, fits in ((0.0, 0.1, False), (0.9, 1.5, False), (2.3, 1.5, True)):
            brick = {"kind": "brick", "floor": 1, "place": [dock.x + away, dock.y + away],
                     "size": [size, 0.2, 0.2], "yaw": 45.0}  # fmt: skip
            if fits:
                resolve_faults(faults_of(brick), site, 0)
            else:
                with pytest.raises(ArgoError, match="over the dock of starting area 1"):
                    resolve_faults(faults_of(brick), site, 0)
        for seed in range(100):  # and none is drawn there
            (drawn,) = resolve_faults(faults_of({"kind": "brick"}), site, seed)
            assert math.dist(drawn.place, (dock.x, dock.y)) > 0.65


def models(base: type[Fault]) -> set[type[Fault]]:
    """Return the models of faults below a base that have a kind of their own."""
    own = {base} if base.model_fields["kind"].default is not PydanticUndefined else set()
    return own.union(*(models(below) for below in base.__subclasses__()))


class TestKinds:
    def test_every_model_of_a_fault_is_listed(self):
        assert models(Fault) == set(KINDS.values())

    @pytest.mark.parametrize("kind", KINDS)
    def test_every_kind_names_its_detection(self, kind):
        sign = KINDS[kind].sign
        assert sign is None or isinstance(sign.event, EventKind)

    @pytest.mark.parametrize("section", ["The kinds", "How faults are sensed"])
    def test_every_kind_has_a_row_in_the_manual(self, section):
        manual = (Path(__file__).parents[3] / "docs" / "faults.md").read_text(encoding="utf-8")
        text = manual.partition(f"\n## {section}\n")[2].partition("\n## ")[0]
        assert re.findall(r"^\| `(\w+)` \|", text, re.MULTILINE) == list(KINDS)


class TestDrawing:
    @pytest.mark.parametrize("kind", KINDS)
    @settings(max_examples=examples(15), deadline=None)
    @given(seed=st.integers(0, 2**32))
    def test_all_fields_that_are_not_given_are_drawn(self, umad, kind, seed):
        faults = faults_of({"kind": kind})
        (resolved,) = resolve_faults(faults, umad, seed)
        assert resolved == resolve_faults(faults, umad, seed)[0]
        assert None not in resolved.model_dump(exclude={"seed", "until", "rect", "floor"}).values()
        # A resolved fault is valid in a file, and resolving it again does not change it.
        again = faults_of(resolved.model_dump(mode="json"))
        assert resolve_faults(again, umad, seed + 1) == (resolved,)

    @pytest.mark.parametrize("kind", KINDS)
    def test_drawn_faults_are_valid_in_files(self, umad, kind):
        faults = faults_of({"kind": kind})
        for seed in range(1500):
            (resolved,) = resolve_faults(faults, umad, seed)
            assert KINDS[kind].model_validate(resolved.model_dump()) == resolved

    @pytest.mark.parametrize("seed", [1885, 2559, 3226])
    def test_displacements_at_the_limit_are_valid(self, umad, seed):
        """Rounded to the nearest digit, these displacements would exceed the limit."""
        (resolved,) = resolve_faults(faults_of({"kind": "displaced_checkpoint"}), umad, seed)
        assert faults_of(resolved.model_dump()) == (resolved,)

    @pytest.mark.parametrize(
        ("low", "high"), [(0.5, 9.5), (0.004, 10.0), (0.0, 9.999), (2.0, 9.997), (20.0, 30.0)]
    )
    def test_values_are_abnormal_however_little_room_there_is(self, low, high):
        site = gauged(low, high)
        for seed in range(500):
            (resolved,) = resolve_faults(faults_of({"kind": "abnormal_value"}), site, seed)
            assert 0.0 <= resolved.value <= 10.0
            assert not low <= resolved.value <= high

    @pytest.mark.parametrize("kind", KINDS)
    def test_given_fields_are_kept(self, umad, kind):
        fields = KINDS[kind].model_fields
        given = {"kind": kind} | ({"at": 7.5, "until": 9.0} if "at" in fields else {})
        (resolved,) = resolve_faults(faults_of(given), umad, 3)
        assert resolved.model_dump(include=set(given)) == given
        assert resolved.start_time == given.get("at", 0.0)
        assert resolved.end_time == given.get("until")

    @settings(max_examples=examples(30), deadline=None)
    @given(seed=st.integers(0, 2**32), until=st.floats(1e-6, 500.0))
    def test_a_fault_begins_before_it_ends(self, umad, seed, until):
        (fault,) = resolve_faults(faults_of({"kind": "emergency_stop", "until": until}), umad, seed)
        assert 0.0 <= fault.start_time < fault.end_time

    def test_a_fault_with_a_seed_of_its_own_is_independent_of_the_others(self, umad):
        own = faults_of({"kind": "gas_leak", "seed": 5})
        assert (
            resolve_faults(own, umad, 1)
            == resolve_faults((*faults_of({"kind": "brick"}), *own), umad, 2)[1:]
        )
        two = faults_of({"kind": "gas_leak"}, {"kind": "gas_leak"})
        assert len({f.place for seed in range(5) for f in resolve_faults(two, umad, seed)}) > 1
        first, second = resolve_faults(two, umad, 1)
        assert first != second

    @settings(max_examples=examples(60), deadline=None)
    @given(seed=st.integers(0, 2**32))
    def test_displacements_keep_to_the_rules(self, umad, seed):
        (fault,) = resolve_faults(faults_of({"kind": "displaced_checkpoint"}), umad, seed)
        assert math.hypot(*fault.offset) <= 0.1 + 1e-9
        assert abs(fault.turn) <= 90

    @settings(max_examples=examples(60), deadline=None)
    @given(seed=st.integers(0, 2**32))
    def test_abnormal_values_are_abnormal(self, umad, seed):
        (fault,) = resolve_faults(faults_of({"kind": "abnormal_value"}), umad, seed)
        checkpoint = umad.checkpoint(fault.checkpoint)
        assert checkpoint.range.contains(fault.value)
        assert not checkpoint.nominal.contains(fault.value)

    def test_faults_survive_json(self):
        given = RunSpec(
            mission=mission(measure(1)), faults=faults_of(*({"kind": kind} for kind in KINDS))
        )
        assert RunSpec.model_validate_json(given.model_dump_json()) == given
        with pytest.raises(ValidationError):
            RunSpec.model_validate({"mission": given.mission, "faults": [{"kind": "flood"}]})


def volume(elements, role):
    """Return the volume (m³) of the boxes of that role."""
    boxes = [s for e in elements if e.role is role for s in e.solids if isinstance(s, Box)]
    return sum(math.prod(b.size) for b in boxes)


class TestChangedSite:
    @settings(max_examples=examples(25), deadline=None)
    @given(seed=st.integers(0, 2**32))
    def test_a_hole_takes_away_its_volume_and_nothing_else(self, umad, seed):
        (fault,) = resolve_faults(faults_of({"kind": "missing_plate"}), umad, seed)
        x0, y0, x1, y1 = fault.rect
        floor = next(f for f in umad.spec.floors if f.number == fault.floor)
        changed = site_with_faults(umad, (fault,))
        lost = volume(umad.elements, Role.DECK) - volume(changed.elements, Role.DECK)
        # The plated share of the rectangle is counted on a fine grid.
        x, y = (np.linspace(a, b, 401) for a, b in ((x0, x1), (y0, y1)))
        x, y = np.meshgrid((x[1:] + x[:-1]) / 2, (y[1:] + y[:-1]) / 2)
        plated = np.zeros(x.shape, dtype=bool)
        for a0, b0, a1, b1 in floor.walkways.values():
            plated |= (x > a0) & (x < a1) & (y > b0) & (y < b1)
        for a0, b0, a1, b1 in floor.openings.values():
            plated &= ~((x > a0) & (x < a1) & (y > b0) & (y < b1))
        assert lost == pytest.approx(plated.mean() * (x1 - x0) * (y1 - y0) * 0.04, rel=0.02)
        assert [e.name for e in changed.elements] == [e.name for e in umad.elements]

    @pytest.mark.physics
    def test_the_world_has_the_hole_and_the_map_has_not(self, umad, robot):
        hole = {"kind": "missing_plate", "floor": 2, "rect": [1.5, 4.6, 2.1, 5.2]}
        brick = {"kind": "brick", "floor": 2, "place": [9.0, 1.6], "yaw": 30.0}
        resolved = resolve_faults(faults_of(hole, brick), umad, 0)
        points = np.array([[1.8, 4.9], [1.45, 4.9], [2.15, 4.9], [9.0, 1.6], [9.3, 1.6]])
        below = np.full(5, 3.3)
        with World(umad, robot, elements=site_with_faults(umad, resolved).elements) as world:
            hollow, *rest = world.surface_or_ray_end_heights(points, below).tolist()
            assert hollow < 2.4
            assert rest == pytest.approx([2.5, 2.5, 2.7, 2.5], abs=1e-3)
            assert world.site is umad
            assert world.obstacle_between((9.0, 1.0, 2.6), (9.0, 2.0, 2.6)) == "brick"
            assert world.obstacle_between((9.0, 1.0, 2.8), (9.0, 2.0, 2.8)) is None
        assert "brick" not in {e.name for e in umad.elements}

    @pytest.mark.physics
    def test_barriers_stand_at_both_ends_of_a_stairway(self, umad, robot):
        (fault,) = resolve_faults(
            faults_of({"kind": "blocked_stairs", "tower": "west tower", "floor": 1}), umad, 0
        )
        with World(umad, robot, elements=site_with_faults(umad, (fault,)).elements) as world:
            for y, z in ((3.5, 0.5), (7.14, 3.0)):
                obstacle = world.obstacle_between((0.85, y - 1.0, z), (0.85, y + 1.0, z))
                assert obstacle == "barrier of the west tower", (y, z)

    def test_several_bricks_have_names_of_their_own(self, umad):
        bricks = resolve_faults(faults_of({"kind": "brick"}, {"kind": "brick"}), umad, 0)
        names = [e.name for e in site_with_faults(umad, bricks).elements]
        assert names[-2:] == ["brick", "brick 2"]
        assert len(set(names)) == len(names)


POSE = BodyPose(5.0, 2.5, 0.0, 0.0)


@pytest.fixture
def targets(umad, robot):
    world, truth = WorldWithoutPhysics(umad, robot), {c.id: 0.0 for c in umad.checkpoints}
    sensor = SensorWithFaults(IdealSensor(world, robot, truth), umad, 0)
    drive = Powertrain(RouteDrive(robot))
    return FaultTargets(
        world, truth, Surroundings(umad), drive, sensor, Battery(robot), RadioNetwork(umad)
    )


def observe_at(targets, observe, times, *data):
    """Return the results of `observe(stage)` at these times, with these faults."""
    faults = resolve_faults(faults_of(*data), targets.world.site, 0)
    schedule, seen = FaultSchedule(faults, targets), []
    for now in times:
        schedule.advance(now)
        seen.append(observe(targets))
    return seen


def fault(kind, at, until=None, **fields):
    return {"kind": kind, "at": at, "until": until, **fields}


def pressed(targets):
    return targets.drive.stop_pressed


def test_the_alarm_sounds_until_the_last_one_ends(targets):
    alarms = fault("platform_alarm", 1, 5), fault("platform_alarm", 3, 8)
    seen = observe_at(
        targets, lambda s: bool(s.surroundings.sources), (0, 2, 4, 6, 7.9, 8), *alarms
    )
    assert seen == [False, True, True, True, True, False]


def test_an_emergency_stop_holds_until_the_last_one_is_released(targets):
    stops = fault("emergency_stop", 10, 50), fault("emergency_stop", 30, 100)
    assert observe_at(targets, pressed, (20, 40, 60, 99, 100), *stops) == [True] * 4 + [False]


def test_a_stop_that_begins_as_another_ends_has_effect(targets):
    stops = fault("emergency_stop", 10, 50), fault("emergency_stop", 50, 100)
    assert observe_at(targets, pressed, (49, 50, 99, 100), *stops) == [True, True, True, False]


def test_the_slowest_of_several_drive_faults_counts(targets):
    slow = (
        fault("drive_dysfunction", 0, speed=0.5),
        fault("drive_dysfunction", 5, 10, speed=0.2),
        fault("drive_dysfunction", 6, 20, speed=0.7),
    )
    assert observe_at(targets, lambda s: s.drive.speed_share, (1, 7, 12, 30), *slow) == [
        0.5,
        0.2,
        0.5,
        0.5,
    ]


def test_a_camera_that_has_failed_stays_so_when_its_noise_ends(targets):
    def sensor_state(targets):
        return targets.sensor.failed, targets.sensor.noise

    faults = (
        fault("sensor_dysfunction", 0, effect="fails"),
        fault("sensor_dysfunction", 5, 10, effect="noise", noise=0.2),
    )
    assert observe_at(targets, sensor_state, (1, 6, 12), *faults) == [
        (True, 0.0),
        (True, 0.2),
        (True, 0.0),
    ]


def test_the_abnormal_value_that_began_last_counts_until_it_ends(targets):
    faults = (
        fault("abnormal_value", 0, 30, checkpoint=1, value=7.0),
        fault("abnormal_value", 5, 20, checkpoint=1, value=9.0),
        fault("abnormal_value", 6, 15, checkpoint=2, value=0.0),
    )
    seen = observe_at(targets, lambda s: s.truth[1], (1, 6, 16, 21, 30), *faults)
    assert seen == [7.0, 9.0, 9.0, 7.0, 0.0]


def test_a_checkpoint_that_was_moved_twice_goes_back_in_two_steps(targets):
    def displacement(offset):
        return {"checkpoint": 1, "offset": offset, "turn": 0.0, "roll": 0.0}

    def height_offset(targets):
        at = targets.world.site.checkpoint(1).position
        return round(targets.world.actual_checkpoint(1).position[2] - at[2], 6)

    faults = (
        fault("displaced_checkpoint", 0, 30, **displacement([0, 0, 0.1])),
        fault("displaced_checkpoint", 5, 20, **displacement([0, 0, -0.05])),
    )
    assert observe_at(targets, height_offset, (1, 6, 21, 30), *faults) == [0.1, -0.05, 0.1, 0.0]


def test_a_connection_is_back_when_nothing_shadows_it(targets):
    lost = fault("connection_loss", 1, 5), fault("connection_loss", 3, 8)
    seen = observe_at(targets, lambda s: s.network.is_connected(POSE), (0, 4, 6, 8), *lost)
    assert seen == [True, False, False, True]


def test_a_checkpoint_with_a_leading_zero_is_read_as_written():
    text = b"faults:\n- {kind: abnormal_value, checkpoint: 010, value: 7.5, at: 0}"
    (fault,) = decode_faults(text, "faults.yaml").faults
    assert fault.checkpoint == 10


def test_a_time_as_a_clock_is_refused():
    text = b"faults:\n- {kind: drive_dysfunction, speed: 0.4, at: 1:30}"
    with pytest.raises(DiagnosticError) as refused:
        decode_faults(text, "faults.yaml")
    assert "faults.yaml:2:45: error: faults[0].at: `at` has to be a number; times are in s" in str(
        refused.value
    )
