"""Tests of evaluation plans: keys, seeds, requirements, and worlds shared by all cases."""

import pytest

from argo_compiler.base.errors import Conflict, Invalid
from argo_env.evaluation.plan import parse_seeds
from argo_env.evaluation.requirement import parse_requirement
from argo_env.evaluation.worlds import Variation
from argo_env.faults.loading import FaultDistribution
from argo_env.run.spec import RunSpec
from tests.processes import run_python


def key_of(plan, **changes):
    case = plan.cases[0]
    spec = case.spec.model_copy(update=changes)
    changed = plan.model_copy(update={"cases": (case.model_copy(update={"spec": spec}),)})
    return changed.key(changed.planned_run(0, 5))


def test_a_key_depends_on_all_that_a_run_depends_on(plan, monkeypatch):
    keys = {
        key_of(plan),
        key_of(plan, drive="kinematic"),
        key_of(plan, sensor="camera"),
        key_of(plan, values={3: 1.5}),
        key_of(plan, mission=plan.cases[0].spec.mission.model_copy(update={"max_duration": 9.0})),
        plan.key(plan.planned_run(0, 6)),
    }
    varied = plan.model_copy(update={"variation": Variation(speed=(0.8, 0.9))})
    keys.add(varied.key(varied.planned_run(0, 5)))
    monkeypatch.setattr("argo_env.evaluation.plan.__version__", "99")
    keys.add(key_of(plan))
    assert len(keys) == 8


def test_a_key_is_the_same_in_another_process(plan, tmp_path):
    (tmp_path / "plan.json").write_text(plan.model_dump_json())
    program = (
        "import sys\nfrom argo_env.evaluation.plan import EvaluationPlan\n"
        "plan = EvaluationPlan.model_validate_json(open(sys.argv[1]).read())\n"
        "print(plan.key(plan.planned_run(0, 5)))"
    )
    process = run_python("-c", program, tmp_path / "plan.json")
    assert process.stdout.strip() == plan.key(plan.planned_run(0, 5))


@pytest.mark.parametrize(
    ("text", "seeds"), [("0..3", (0, 1, 2, 3)), ("7", (7,)), ("1, 4..5,9", (1, 4, 5, 9))]
)
def test_seeds_as_people_write_them(text, seeds):
    assert parse_seeds(text) == seeds


@pytest.mark.parametrize(
    "text",
    ["9223372036854775808", "", "a", "3..1", "1,1", "0..2,2", "-1", "0...3", "0..99999999"],
)
def test_other_texts_are_no_seeds(text):
    with pytest.raises(Invalid, match="seeds"):
        parse_seeds(text)


def test_requirements_as_people_write_them():
    assert str(parse_requirement("success >= 0.98")) == "success >= 0.98"
    assert parse_requirement("contact<=1%").share == 0.01
    assert not parse_requirement(" false alarm <= 5 % ").at_least


@pytest.mark.parametrize(
    "text", ["success > 0.9", "luck >= 0.5", "success >= 1", "success >= 100 %", "success >= 0",
             "success >= 1.2.3", ""]
)  # fmt: skip
def test_other_texts_are_no_requirements(text):
    with pytest.raises(Invalid, match="requirement"):
        parse_requirement(text)


def test_equal_cases_and_equal_seeds_are_refused(plan):
    twice = plan.model_copy(update={"cases": plan.cases * 2})
    with pytest.raises(Conflict, match="there twice"):
        twice.check()
    with pytest.raises(Conflict, match="a seed is there twice"):
        plan.model_copy(update={"seeds": (1, 1)}).check()


def varied(**ranges):
    return Variation.model_validate(ranges)


def test_one_more_draw_changes_nothing_of_the_others(mission):
    """A further varied value or another mission changes no other draw (common random numbers)."""
    spec = RunSpec(mission=mission, drive="route")
    few = varied(charge=(0.5, 1.0), values={3: {"drift": (-1.0, 1.0)}})
    more = varied(
        charge=(0.5, 1.0),
        speed=(0.7, 1.0),
        values={1: {"noise": (0.0, 0.2)}, 3: {"drift": (-1.0, 1.0)}},
    )
    longer = spec.model_copy(update={"mission": mission.model_copy(update={"max_duration": 99.0})})
    for seed in range(20):
        a, b = few.apply(spec, seed).conditions, more.apply(longer, seed).conditions
        assert a.charge == b.charge
        assert a.values[3].drift == b.values[3].drift
    assert len({few.apply(spec, seed).conditions.charge for seed in range(20)}) == 20


def test_draws_stay_in_their_ranges_and_fill_them(mission):
    spec = RunSpec(mission=mission, drive="route")
    between = varied(turned=(-10.0, 10.0), values={2: {"start": (1.0, 2.0), "steps": [
        {"at": (10, 20), "change": 0.5}]}})  # fmt: skip
    specs = [between.apply(spec, seed) for seed in range(200)]
    turned = [drawn.conditions.turned for drawn in specs]
    assert -10 <= min(turned) < -9 < 9 < max(turned) <= 10
    assert all(1 <= drawn.values[2] <= 2 for drawn in specs)
    steps = [drawn.conditions.values[2].steps[0] for drawn in specs]
    assert all(10 <= step.at <= 20 and step.change == 0.5 for step in steps)
    assert between.values_for(3)["turned"] == specs[3].conditions.turned


@pytest.mark.parametrize(
    ("ranges", "message"),
    [
        ({"speed": (0.9, 0.8)}, "give the smaller value first"),
        ({"speed": (0.9, 1.5)}, "less than or equal to 1"),
        ({"charge": (0.0, 0.5)}, "greater than 0"),
        ({"colour": 3}, "Extra inputs"),
    ],
)
def test_impossible_ranges_are_refused(ranges, message):
    with pytest.raises(ValueError, match=message):
        varied(**ranges)


def test_faults_come_as_often_as_they_are_probable(mission):
    chances = [
        {"name": "brick", "probability": 0.2, "faults": [{"kind": "brick"}]},
        {"name": "weak", "probability": 0.1, "faults": [{"kind": "low_battery"}]},
    ]
    distribution = FaultDistribution.model_validate({"chances": chances})
    variation = Variation(faults=distribution)
    spec = RunSpec(mission=mission)
    kinds = [tuple(f.kind for f in variation.apply(spec, s).faults) for s in range(3_000)]
    assert kinds.count(("brick",)) / 3_000 == pytest.approx(0.2, abs=0.025)
    assert kinds.count(("low_battery",)) / 3_000 == pytest.approx(0.1, abs=0.02)
    assert distribution.fault_free_probability == pytest.approx(0.7)
    with pytest.raises(ValueError, match=r"add up to 1\.1"):
        FaultDistribution.model_validate(
            {"chances": [{**chances[0], "probability": 1.0}, chances[1]]}
        )
