"""Journals: a run that is cut short anywhere continues, and nothing is lost or done twice."""

import os
import re
import resource
import signal
from contextlib import contextmanager
from dataclasses import replace
from itertools import count, pairwise
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import argo_env.run.journal
from argo_compiler.base.errors import ArgoError, Conflict, Invalid, Remedy, Unavailable
from argo_compiler.hfsm import (
    ActionFailed,
    ActionStopped,
    ActionSucceeded,
    Cancel,
    Occurred,
    Outcome,
    Pause,
    Resume,
    Tick,
)
from argo_compiler.il import EventKind, Group
from argo_env.files.checked_lines import checked_line
from argo_env.formatting import rounded_time_text
from argo_env.navigation import Navigator
from argo_env.run.journal import (
    Header,
    create_journal,
    open_journal,
)
from argo_env.run.log import LoggedEvent
from argo_env.run.observer import Observer
from argo_env.run.session import resume
from argo_env.run.simulation import SAMPLE_PERIOD
from argo_env.run.spec import RunSpec, logged_events
from argo_env.world.world import Touch
from tests.conftest import examples, sample
from tests.yard import (
    EmptyWorld,
    Watching,
    fast_setup,
    measure,
    mission,
    opened,
    run_with,
    shelter,
    simulated,
    simulation_of,
    site_of,
    waypoint,
)

SHELTER = shelter(3.05, 1.55)
PLAN = mission(
    measure(1, retries=1),
    waypoint("A", 2.05, 2.05),
    waypoint("B", 4.05, 2.05),
    measure(2),
    measure(3),
    groups=(Group(name="Round", start="A", end="B", max_repeat_duration=25.0),),
    reactions=(SHELTER,),
    max_duration=600.0,
)
EVENTS = (
    (5.0, Occurred(EventKind.GAS_LEAK, "a hiss")),
    (5.0, Occurred(EventKind.HOT_SPOT)),
    (16.0, Occurred(EventKind.ALL_CLEAR)),
    (30.0, Pause()),
    (34.0, Resume()),
)


def header(yard, plan=PLAN, events=EVENTS, source=None):
    spec = RunSpec(mission=plan, site="yard", seed=1, events=logged_events(*events), source=source)
    return Header.from_run(opened(yard), spec)


def continue_journal(
    yard, journal, plan=PLAN, events=EVENTS, observe=None, announce=None, **options
):
    """Run from the end of the journal and return the record."""
    return run_with(
        plan, fast_setup(yard, {2: 5.5}), journal=journal, observers=[Watching(observe, announce)],
        seed=1, events=logged_events(*events), **options,
    )  # fmt: skip


def resumed(yard, path):
    """Continue the run of a journal to its end; return the record and the announced readings."""
    announced = []
    with open_journal(path) as journal:
        record = continue_journal(yard, journal, announce=announced.append)
    return record, announced


@pytest.fixture
def path(tmp_path):
    """Return the path of the journal of a test."""
    return tmp_path / "run.journal"


class CompleteRun:
    """Content of a journal and the record of its run, with a short text for failed tests."""

    def __init__(self, content, record):
        self.content = content
        self.record = record

    def __repr__(self):
        return "complete run"


@pytest.fixture(scope="module")
def complete(yard, tmp_path_factory):
    """Return the journal of a run that was never cut short, and its record."""
    path = tmp_path_factory.mktemp("complete") / "run.journal"
    announced = []
    with create_journal(path, header(yard)) as journal:
        record = continue_journal(yard, journal, announce=announced.append)
    assert tuple(announced) == record.readings
    return CompleteRun(path.read_bytes(), record)


def done_tasks(record):
    return [t.task for t in record.tasks if t.outcome == "done"]


def require_the_same_mission(record, reference):
    """Require the same tasks and readings; only the durations of actions may differ."""
    assert record.result.outcome is reference.result.outcome
    assert record.result.success is reference.result.success
    assert record.result.verdict == reference.result.verdict
    assert record.result.docked == reference.result.docked
    assert [(r.task, r.value, r.normal) for r in record.readings] == [
        (r.task, r.value, r.normal) for r in reference.readings
    ]
    for name in ("MEASURE 1", "MEASURE 2", "MEASURE 3"):
        assert done_tasks(record).count(name) == 1
    assert done_tasks(record).count("react to gas_leak") == 1
    assert [i.event for i in record.interruptions] == [i.event for i in reference.interruptions]
    driven = sum(t.distance for t in record.tasks)
    assert driven == pytest.approx(record.result.distance, abs=0.01)
    assert record.tasks[0].start == 0.0
    assert all(a.end <= b.start for a, b in pairwise(record.tasks))
    assert all(a.t < b.t for a, b in pairwise(record.path))
    assert max(b.t - a.t for a, b in pairwise(record.path)) <= SAMPLE_PERIOD + 1e-6
    assert (record.path[0].t, record.path[-1].t) == (0.0, record.result.duration)
    times = [step.t for step in record.trace]
    assert times == sorted(times)
    assert record.tasks[-1].end == record.result.duration


def require_a_continuation(record, reference, reached):
    """Require the reference's record up to the time `reached` (s), and its results after that."""
    require_the_same_mission(record, reference)
    for name, at in (("tasks", "end"), ("readings", "t"), ("path", "t")):
        before = [x for x in getattr(reference, name) if getattr(x, at) <= reached]
        assert list(getattr(record, name)[: len(before)]) == before
    assert record.resumed == (reached,)


def test_the_reference_has_all_that_may_happen(complete):
    record = complete.record
    assert record.result.outcome is Outcome.COMPLETED
    assert {t.outcome for t in record.tasks} == {"done", "interrupted", "cancelled"}
    assert "react to gas_leak" in done_tasks(record)
    assert [i.event for i in record.interruptions] == [EventKind.GAS_LEAK, None]
    assert [r.normal for r in record.readings] == [True, False, True]


def test_a_journal_changes_nothing(yard, complete):
    record = complete.record
    assert continue_journal(yard, None) == record


def test_cut_at_every_line_end(yard, complete, path):
    content, reference = complete.content, complete.record
    ends = [k + 1 for k, byte in enumerate(content) if byte == ord("\n")]
    assert len(ends) > 100
    for end in sample(ends, 5):
        path.write_bytes(content[:end])
        with open_journal(path) as journal:
            entries = journal.entries
        record, told = resumed(yard, path)
        known = [e.reading for e in entries if e.reading]
        assert [*known, *told] == list(record.readings)
        if entries and not entries[-1].ended and not record.resumed:
            # The state machine had come to its end; only the last line was missing.
            assert record == reference
        elif entries and not entries[-1].ended:
            require_a_continuation(record, reference, entries[-1].t)
        else:
            assert record == reference


def test_interrupted_after_any_step(yard, complete, path):
    """The record equals the reference's so far, and the journal leads to the complete one."""
    reference = complete.record
    steps = round(reference.result.duration / 0.1)
    for n in sample(range(steps), 101):
        path.unlink(missing_ok=True)
        calls = count()
        with create_journal(path, header(yard)) as journal:
            record = continue_journal(yard, journal, interrupted=lambda: next(calls) >= n)  # noqa: B023
        assert not record.result.ended
        assert not record.result.success
        assert (
            record.result.verdict == f"the mission has not ended after {rounded_time_text(n / 10)}"
        )
        assert record.result.duration == n / 10
        for name in ("tasks", "readings", "anomalies", "trace"):
            so_far = getattr(record, name)
            assert so_far == getattr(reference, name)[: len(so_far)]
        with open_journal(path) as journal:
            assert not journal.had_ended_when_opened
            reached = journal.entries[-1].t if journal.entries else None
        continued, announced = resumed(yard, path)
        assert (*record.readings, *announced) == continued.readings
        if reached is None:
            assert continued == reference
        else:
            assert record.result.duration - reached <= SAMPLE_PERIOD
            require_a_continuation(continued, reference, reached)


def test_an_interruption_is_told_and_the_simulation_can_go_on(yard):
    records, answers = [], iter([False] * 20 + [True])

    class RecordKeeper(Observer):
        def on_interrupted(self, record):
            records.append(record)

    spec = RunSpec(mission=PLAN, site="yard")
    with simulation_of(
        spec, opened(yard), observers=[RecordKeeper()], setup=fast_setup(yard)
    ) as simulation:
        record = simulation.run(lambda: next(answers))
        assert records == [record]
        assert record.result.duration == 2.0
        complete = simulation.run()
        assert records == [record]
    assert complete.result.ended
    assert complete == run_with(PLAN, fast_setup(yard))


def test_a_run_that_has_ended_can_be_told_nothing(yard, complete, path):
    path.write_bytes(complete.content)
    with (
        open_journal(path) as journal,
        pytest.raises(Conflict, match=r"run\.journal: the run has ended, at") as caught,
    ):
        resume(journal, opened(yard), events=logged_events((5.0, Pause())))
    assert caught.value.remedies == (Remedy.RUN_ANEW,)
    assert path.read_bytes() == complete.content


@pytest.mark.long
def test_cut_at_every_byte_of_the_last_lines(yard, path):
    """The last lines of a short run hold the ends of its action and of the run itself."""
    plan = mission(measure(1))

    def to_the_end():
        with open_journal(path) as journal:
            return continue_journal(yard, journal, plan, ())

    with create_journal(path, header(yard, plan, ())) as journal:
        reference = continue_journal(yard, journal, plan, ())
    content = path.read_bytes()
    first = len(content) - sum(map(len, content.splitlines(keepends=True)[-4:]))
    to_continue = set(sample(range(first, len(content)), 10))
    for cut in range(first, len(content)):
        path.write_bytes(content[:cut])
        with open_journal(path) as journal:
            complete = content[:cut].split(b"\n")[1:-1]
            assert len(journal.entries) == sum(b'"t":' in line for line in complete)
        if cut not in to_continue:
            continue
        path.write_bytes(content[:cut])
        record = to_the_end()
        assert done_tasks(record) == ["MEASURE 1"]
        assert [r.value for r in record.readings] == [r.value for r in reference.readings]
        assert record.result.verdict == reference.result.verdict
        # Now the journal is complete, and a second run changes nothing.
        ended = path.read_bytes()
        assert to_the_end() == record
        assert path.read_bytes() == ended


@settings(max_examples=examples(10), deadline=None)
@given(st.lists(st.floats(0.0, 1.0), min_size=1, max_size=4))
def test_cut_again_and_again(yard, complete, tmp_path_factory, places):
    """A run continues to its end each time its journal is cut at any byte after the first line."""
    content, reference = complete.content, complete.record
    path = tmp_path_factory.mktemp("again") / "run.journal"
    path.write_bytes(content)
    least = content.index(b"\n") + 1
    for place in places:
        content = path.read_bytes()
        cut = least + int(place * (len(content) - least))
        path.write_bytes(content[:cut])
        with open_journal(path) as journal:
            certain = [e.reading for e in journal.entries if e.reading]
        record, announced = resumed(yard, path)
        require_the_same_mission(record, reference)
        assert [*certain, *announced] == list(record.readings)
        assert list(record.resumed) == sorted(record.resumed)


def test_a_reading_is_on_disk_when_it_is_told(yard, path):
    seen = []

    def announce(reading):
        entries = argo_env.run.journal._parse(path, path.read_bytes())[1]
        seen.append(entries[-1].reading == reading)

    def observe(now, _):
        last = argo_env.run.journal._parse(path, path.read_bytes())[1][-1]
        assert now - last.t < SAMPLE_PERIOD

    plan = mission(measure(1), measure(2))
    with create_journal(path, header(yard, plan, ())) as journal:
        continue_journal(yard, journal, plan, (), observe, announce)
    assert seen == [True, True]


class Scraping(EmptyWorld):
    """World in which the robot scrapes along a crate on a part of its path."""

    def __init__(self, drive):
        super().__init__()
        self._drive = drive

    def touches(self):
        x = self._drive.pose.x
        if 1.5 < x < 2.2:
            return (Touch("base_link", "crate", (x, 1.0, 0.5), 0.01 * x),)
        return ()


def test_contacts_go_on_as_well(yard, path):
    def run(journal):
        setup = fast_setup(yard)
        setup = replace(setup, world=Scraping(setup.drive))
        return run_with(plan, setup, journal=journal, seed=1)

    plan = mission(waypoint("A", 3.05, 1.05), waypoint("B", 1.05, 1.05))
    with create_journal(path, header(yard, plan, ())) as journal:
        reference = run(journal)
    assert len(reference.contacts) == 2
    content = path.read_bytes()
    lines = content.splitlines(keepends=True)
    for cut in range(1, len(lines), 3):
        path.write_bytes(b"".join(lines[:cut]))
        with open_journal(path) as journal:
            reached = journal.entries[-1].t if journal.entries else 0.0
            record = run(journal)
        assert len(record.contacts) == 2
        for contact, before in zip(record.contacts, reference.contacts, strict=True):
            assert contact.depth == pytest.approx(before.depth, abs=0.002)
            assert contact == before or contact.end >= reached - 0.1
            assert contact.start == before.start or before.start > reached


@pytest.mark.physics
def test_simulate_and_resume_in_the_world(yard, path):
    plan = mission(measure(1), measure(2), end_area=1)
    reference = simulated(plan, yard, seed=4, values={2: 4.0}, journal=path)
    assert simulated(plan, yard, seed=4, values={2: 4.0}) == reference
    content = path.read_bytes()
    lines = content.splitlines(keepends=True)
    path.write_bytes(b"".join(lines[: len(lines) // 2])[:-3])
    with open_journal(path) as journal:
        at = journal.entries[-1].t
        record = resume(journal, opened(yard))
    assert 0.0 < at < reference.result.duration
    assert record.resumed == (at,)
    assert record.seed == 4
    assert [r.value for r in record.readings] == [r.value for r in reference.readings]
    assert record.result.duration == pytest.approx(reference.result.duration, abs=10.0)


def events():
    names = st.text(min_size=1)
    return st.one_of(
        st.builds(ActionSucceeded, names, st.none() | st.floats(-1e9, 1e9)),
        st.builds(ActionFailed, names, st.text()),
        st.builds(ActionStopped, names),
        st.builds(Occurred, st.sampled_from(EventKind), st.text()),
        st.sampled_from([Tick(), Pause(), Resume(), Cancel()]),
    )


@settings(max_examples=examples(50), deadline=None)
@given(events())
def test_events_go_through_json(event):
    text = LoggedEvent.from_event(event).model_dump_json()
    assert LoggedEvent.model_validate_json(text).to_event() == event


@pytest.mark.parametrize("more", [b"0 {}\n" * 2, b"0 {}\n0", bytes(4096), b"\0"])
def test_damage_after_the_last_synced_line_is_told(complete, path, more):
    path.write_bytes(complete.content + more)
    with open_journal(path) as journal:
        assert re.search(r"run\.journal: damaged from line \d+ on.*the run had ended", journal.loss)
        lost = "2 lines" if more.count(b"0 {}\n") == 2 else "1 line"
        assert f"the loss is at least {lost}, not known to be on disk" in journal.loss
        assert journal.had_ended_when_opened
    assert path.read_bytes() == complete.content + more


def synced_size(content):
    """Return the number of bytes up to the end of the last line that a mark states to be synced."""
    lines = content.splitlines(keepends=True)
    last = max(k for k, line in enumerate(lines) if re.fullmatch(rb'\S+ {"n":\d+}\n', line))
    return len(b"".join(lines[:last]))


def test_a_page_that_was_not_synced_is_lost_with_all_that_follows(yard, complete, path):
    """A loss of power leaves any of the pages that were not synced as zeros."""
    reference, content = complete.record, complete.content
    lines = content.splitlines(keepends=True)
    whole = b"".join(lines[: len(lines) // 3])
    end = synced_size(whole)
    assert len(whole) - end > 1000
    path.write_bytes(whole[:end] + bytes(400) + whole[end + 400 :])
    with open_journal(path) as journal:
        assert re.search(r"from line \d+ on, as by a loss of power: the loss is at", journal.loss)
        assert "with what the run did until" in journal.loss
        reached = journal.entries[-1].t
        assert f"the run continues at {reached:g} s" in journal.loss
        assert journal.entries[-1].must_survive_power_loss
    record, _ = resumed(yard, path)
    require_a_continuation(record, reference, reached)
    with open_journal(path) as journal:
        assert not journal.loss


def test_a_synced_page_that_is_lost_is_damage(complete, path):
    content = complete.content
    for at in range(content.index(b"\n") + 1, synced_size(content) - 100, 1500):
        damaged = content[:at] + bytes(100) + content[at + 100 :]
        path.write_bytes(damaged)
        with pytest.raises(Invalid, match=r"damaged from line \d+ on, .* is no loss of power"):
            open_journal(path)
        assert path.read_bytes() == damaged


def test_a_journal_without_marks_is_read(complete, path):
    """Journals had no marks, and did not state what was synced."""
    with open_journal_of(complete.content, path) as journal:
        entries = journal.entries
    old = [journal.header.model_dump(mode="json") | {"format": "argo journal", "version": 4}]
    old += [entry.model_dump(mode="json", exclude_defaults=True) for entry in entries]
    lines = [checked_line({"n": number} | data) for number, data in enumerate(old)]
    with open_journal_of(b"".join(lines[:100]), path) as journal:
        assert (journal.entries, journal.loss) == (entries[:99], "")
    with pytest.raises(Invalid, match="damaged from line 51 on"):
        open_journal_of(b"".join(lines[:50] + lines[51:]), path)


def open_journal_of(content, path):
    path.write_bytes(content)
    return open_journal(path)


class TestRefusals:
    def test_two_processes(self, yard, path):
        with create_journal(path, header(yard)), pytest.raises(ArgoError, match="in use"):
            open_journal(path)
        with open_journal(path), pytest.raises(ArgoError, match="in use"):
            open_journal(path)
        open_journal(path).close()

    def test_a_journal_that_is_there_already(self, yard, path, tmp_path):
        create_journal(path, header(yard)).close()
        before = path.read_bytes()
        with pytest.raises(Conflict, match=r"run\.journal already exists") as caught:
            create_journal(path, header(yard))
        assert (caught.value.remedies, caught.value.about) == ((Remedy.RESUME,), str(path))
        assert path.read_bytes() == before
        assert list(tmp_path.iterdir()) == [path]

    @pytest.mark.skipif(not Path("/proc").is_dir(), reason="needs a folder without room for files")
    def test_a_place_where_nothing_can_be_made_is_named_as_it_was_given(self, yard):
        with pytest.raises(Unavailable, match=r"^/proc/j .*can't be written.*: .*choose another"):
            create_journal(Path("/proc/j"), header(yard))

    def test_killed_while_the_first_line_was_written(self, yard, path, tmp_path):
        """A new journal can be written although another process has left a draft of a header."""
        (tmp_path / "run.journal.new").write_bytes(b"0123 half a li" * 1000)
        create_journal(path, header(yard)).close()
        with open_journal(path) as journal:
            assert journal.header == header(yard)
        assert list(tmp_path.iterdir()) == [path]

    @pytest.mark.parametrize(
        ("content", "says"),
        [
            (b"", "is not a journal"),
            (b"\n\n\n", "is not a journal"),
            (b'{"version": 2, "tasks": []}\n', "is not a journal"),
            (bytes(range(256)) * 100, "is not a journal"),
            (b"0" * 3_000_000, "is not a journal"),
        ],
    )
    def test_files_that_are_none(self, tmp_path, content, says):
        path = tmp_path / "file"
        path.write_bytes(content)
        with pytest.raises(ArgoError, match=says):
            open_journal(path)
        assert path.read_bytes() == content

    @pytest.mark.parametrize("cut", [0, 1, 8, 9, 50, -2, -1])
    def test_the_first_line_is_not_whole(self, yard, path, cut):
        create_journal(path, header(yard)).close()
        first_line = path.read_bytes().splitlines(keepends=True)[0]
        path.write_bytes(first_line[:cut])
        with pytest.raises(ArgoError, match="is not a journal, or its first line is damaged"):
            open_journal(path)

    @pytest.mark.parametrize("name", [".", "/dev/null", "missing.journal", "no/such/folder/j"])
    def test_places_that_are_no_files(self, tmp_path, monkeypatch, name):
        monkeypatch.chdir(tmp_path)
        with pytest.raises(ArgoError, match=r"is not a file|there is no such journal"):
            open_journal(Path(name))

    @pytest.mark.parametrize("name", [".", "/dev/full", "no/such/folder/j"])
    def test_places_that_can_not_be_written(self, yard, tmp_path, monkeypatch, name):
        monkeypatch.chdir(tmp_path)
        with pytest.raises(ArgoError, match=r"already exists|is in a folder that does not exist"):
            create_journal(Path(name), header(yard))

    def test_another_version(self, yard, path):
        future = header(yard).model_copy(update={"version": 7})
        create_journal(path, future).close()
        with pytest.raises(ArgoError, match="has version 7 of the journal's format"):
            open_journal(path)

    def test_damage_in_the_middle(self, complete, path):
        content = complete.content
        lines = content.splitlines(keepends=True)
        bad = bytes([lines[20][40] ^ 1])
        lines[20] = lines[20][:40] + bad + lines[20][41:]
        path.write_bytes(b"".join(lines))
        with pytest.raises(ArgoError, match="damaged from line 21 on"):
            open_journal(path)
        assert path.read_bytes() == b"".join(lines)
        path.write_bytes(b"".join(lines[:20] + lines[21:]))
        with pytest.raises(ArgoError, match="damaged from line 21 on"):
            open_journal(path)

    def test_line_ends_of_another_system(self, complete, path):
        content = complete.content.replace(b"\n", b"\r\n")
        path.write_bytes(content)
        with pytest.raises(ArgoError, match="CR LF"):
            open_journal(path)
        assert path.read_bytes() == content

    def test_a_changed_site(self, yard, path):
        create_journal(path, header(yard)).close()
        other = site_of(title="Yard 2", storey=3.0)
        with open_journal(path) as journal, pytest.raises(ArgoError) as refused:
            resume(journal, opened(Navigator(other, yard.robot)))
        assert "site's storey" in str(refused.value)
        assert "site's title" in str(refused.value)
        assert "floors" not in str(refused.value)

    def test_another_argo(self, yard, path, monkeypatch):
        create_journal(path, header(yard)).close()
        monkeypatch.setattr(argo_env.run.journal, "__version__", "99.9")
        with open_journal(path) as journal, pytest.raises(ArgoError, match=r"Argo .*is 99\.9"):
            resume(journal, opened(yard))

    def test_a_changed_mission_file(self, yard, path, tmp_path):
        source = tmp_path / "mission.json"
        source.write_text("first")
        create_journal(path, header(yard, source=str(source))).close()
        with open_journal(path) as journal:
            journal.require_inputs_unchanged(opened(yard))
            source.write_text("second")
            with pytest.raises(ArgoError, match="mission file"):
                resume(journal, opened(yard))
            # The journal holds the mission itself.
            source.unlink()
            journal.require_inputs_unchanged(opened(yard))

    def test_entries_of_another_mission(self, yard, complete, path):
        content = complete.content
        other = mission(waypoint("A", 2.05, 2.05))
        create_journal(path, header(yard, other)).close()
        path.write_bytes(path.read_bytes() + content.split(b"\n", 2)[2])
        with open_journal(path) as journal, pytest.raises(ArgoError, match="does not fit"):
            continue_journal(yard, journal, other)


@contextmanager
def files_up_to(size):
    """Limit the size of files to `size` bytes."""
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    ignored = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    try:
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, limits[1]))
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
        signal.signal(signal.SIGXFSZ, ignored)


def test_a_full_disk(yard, complete, path):
    """A run without room ends with a message, and continues from its journal when there is room."""
    reference = complete.record
    with create_journal(path, header(yard)) as journal:
        further = r"can't be written any further"
        with files_up_to(20_000), pytest.raises(ArgoError, match=further) as caught:
            continue_journal(yard, journal)
        assert caught.value.remedies == (Remedy.RESUME,)
    assert 19_000 < path.stat().st_size <= 20_000
    with open_journal(path) as journal:
        reached = journal.entries[-1].t
    record, _ = resumed(yard, path)
    require_a_continuation(record, reference, reached)


def test_one_that_is_there_is_replaced_on_demand_unless_it_is_in_use(yard, path, tmp_path):
    with create_journal(path, header(yard)) as journal:
        before = path.read_bytes()
        with pytest.raises(Conflict, match="already exists"):
            create_journal(path, header(yard))
        with pytest.raises(Conflict, match="is in use"):
            create_journal(path, header(yard), replace=True)
        assert path.read_bytes() == before
        assert journal.path == path
    path.write_text("old")
    create_journal(path, header(yard), replace=True).close()
    assert path.read_bytes() == before
    assert os.listdir(tmp_path) == ["run.journal"]


def test_no_room_for_the_first_line(yard, path, tmp_path):
    with files_up_to(100), pytest.raises(ArgoError, match="can't be written: File too large"):
        create_journal(path, header(yard))
    assert os.listdir(tmp_path) == []
