"""Random edits keep the rules of the language, can be undone, and report what they change."""

import random
from collections import Counter

from hypothesis import given, settings
from hypothesis import strategies as st

from argo_compiler.base.errors import Conflict, Invalid, NotFound
from argo_compiler.checks import check
from argo_compiler.diagnostics import Severity
from argo_compiler.diagnostics.codes import CODES
from argo_compiler.diagnostics.subject import subject_of
from argo_compiler.editing import EditError
from argo_compiler.editing.commands import FUNCTIONS, apply, read_edit
from argo_compiler.hfsm import lower
from argo_compiler.il import Mission
from tests.argo_compiler.editing.random_edits import random_edit
from tests.argo_compiler.editing.rules import broken_rules
from tests.argo_compiler.hfsm.random_missions import missions as tangled_missions
from tests.argo_compiler.script.conftest import make_catalog
from tests.conftest import examples
from tests.missions_all import missions as all_missions
from tests.missions_sound import sound_missions

EDITS = 50
seeds = st.integers(0, 2**32)


def errors(mission: Mission) -> Counter[str]:
    return Counter(f.code for f in check(mission) if f.severity is Severity.ERROR)


def try_edit(mission, edit):
    """Return the result of an edit, or None if it is refused with diagnostics."""
    try:
        return apply(mission, edit)
    except EditError as error:
        refusal = error
    assert isinstance(refusal, (NotFound, Invalid, Conflict))
    assert refusal.diagnostics
    for diagnostic in refusal.diagnostics:
        assert diagnostic.code in CODES
        assert diagnostic.message
        assert diagnostic.hint
    return None


def run(mission: Mission, seed: int) -> list[tuple[Mission, object]]:
    """Return each mission of a sequence of random edits, with the edit that produced it."""
    rng = random.Random(seed)
    steps = []
    for _ in range(EDITS):
        edit = random_edit(mission, rng)
        made = try_edit(mission, edit)
        if made is not None:
            mission = made.mission
            steps.append((mission, edit))
    return steps


@settings(max_examples=examples(80))
@given(sound_missions(make_catalog()) | tangled_missions(), seeds)
def test_fifty_edits_keep_the_rules_and_snapshots_undo_them(mission, seed):
    written = mission.model_dump_json()
    initial_errors = errors(mission)
    snapshots = [(mission, written)]
    for made, edit in run(mission, seed):
        # The independent rules do not include endless groups: only `check` finds those.
        assert not errors(made) - initial_errors
        assert not broken_rules(made) - broken_rules(mission)
        if not initial_errors:
            lower(made)
        again = apply(snapshots[-1][0], read_edit(edit.model_dump_json()))
        assert again.mission == made
        snapshots.append((made, made.model_dump_json()))
    for snapshot, text in reversed(snapshots):
        assert snapshot.model_dump_json() == text
        assert Mission.model_validate_json(text) == snapshot


@settings(max_examples=examples(60))
@given(all_missions(), seeds)
def test_edits_add_no_errors_to_an_invalid_mission(mission, seed):
    before, broken_before = errors(mission), broken_rules(mission)
    for made, _ in run(mission, seed):
        assert set(errors(made)) <= set(before) | {"il.endless-group"} or not mission.tasks
        assert set(broken_rules(made)) <= set(broken_before)


@settings(max_examples=examples(80))
@given(sound_missions(make_catalog()) | tangled_missions(), seeds)
def test_consequences_are_exactly_the_other_changes(mission, seed):
    rng = random.Random(seed)
    for _ in range(10):
        edit = random_edit(mission, rng)
        made = try_edit(mission, edit)
        if made is None:
            continue
        subjects = [c.subject for c in made.consequences]
        assert all(c.before != c.after and c.message for c in made.consequences)
        changed = set(differences(mission, made.mission, edit))
        named = {s.partition("']")[0] + "']" if "']" in s else s for s in subjects}
        assert named - {"tasks"} == changed
        mission = made.mission


def differences(before, after, edit):
    """Yield the subjects that differ between two missions and that the edit does not name."""
    named_by_edit = {getattr(edit, field, None) for field in ("name", "new_name")}
    task = getattr(edit, "task", None)
    requested = {task} if isinstance(task, str) else {getattr(task, "name", None)}
    kind = edit.kind
    renamed = {edit.name: edit.new_name} if kind == "rename_task" else {}
    if kind == "replace_task":
        renamed = {edit.name: edit.task.name}
    old = {renamed.get(t.name, t.name): t for t in before.tasks}
    for t in after.tasks:
        was = old.get(t.name)
        if was is None or (t.name in requested and kind != "add_task"):
            continue
        own = kind == "change_task" and t.name == edit.name  # sets what follows a failure itself
        is_changed = (was.transitions, was.group) != (t.transitions, t.group)
        if is_changed or (not own and branch_targets(was) != branch_targets(t)):
            yield subject_of("tasks", t.name)
    if kind != "set_header" and before.current != after.current:
        yield "current"
    groups = {g.name: g for g in after.groups}
    pairs = zip(before.groups, after.groups, strict=False)
    same = len(before.groups) == len(after.groups)
    names = {a.name: b.name for a, b in pairs} if same else {}
    if kind == "wrap_tasks":
        names = {a.name: b.name for a, b in zip(before.groups, after.groups[:-1], strict=True)}
    if kind == "dissolve_group":
        remaining = [g for g in before.groups if g.name != edit.name]
        names = {a.name: b.name for a, b in zip(remaining, after.groups, strict=True)}
    for g in before.groups:
        if kind in ("change_group", "dissolve_group", "rename_group") and g.name in named_by_edit:
            continue
        new = groups.get(names.get(g.name, g.name))
        if new is None:
            yield subject_of("groups", g.name)
        elif (new.name, new.start, new.end) != (g.name, g.start, g.end):
            yield subject_of("groups", new.name)


def branch_targets(task):
    """Return the tasks that follow if the task failed, and if it missed its window."""
    return task.failure_target, task.window and task.window.missed_target


def test_every_kind_of_edit_is_made_and_refused():
    """The random edits are a useful sample: each kind is made often and refused sometimes."""
    made, refused = Counter(), Counter()

    @settings(max_examples=60)
    @given(sound_missions(make_catalog()), seeds)
    def count(mission, seed):
        rng = random.Random(seed)
        for _ in range(EDITS):
            edit = random_edit(mission, rng)
            result = try_edit(mission, edit)
            (refused if result is None else made)[edit.kind] += 1
            mission = mission if result is None else result.mission

    count()
    assert set(made) == set(refused) == set(FUNCTIONS)
    assert min(made.values()) > 5
    assert made.total() > refused.total() / 2
