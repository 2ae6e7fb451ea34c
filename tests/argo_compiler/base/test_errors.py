"""Errors keep all their data when pools pass them from worker to caller by pickle."""

import copy
import pickle
from pathlib import Path

import pytest

import argo_env.closing
from argo_compiler.base.errors import (
    ArgoError,
    Conflict,
    Invalid,
    NotFound,
    Remedy,
    Unavailable,
    Unreachable,
)
from argo_compiler.base.limited_process import LimitExceeded
from argo_compiler.diagnostics import Diagnostic, DiagnosticError, Severity, Span
from argo_compiler.editing import EditConflict, EditError, EditInvalid, EditNotFound
from argo_compiler.files.loading import FileError, FileProblem, MissingFile, UnreadableFile
from argo_compiler.script import Draft, IncompleteDraft
from argo_env.recording.output import UnwritableRecording
from argo_planner.service.core.refusals import (
    ChangedSince,
    CommandIdTaken,
    EditRefused,
    FiledSince,
    NothingToUndo,
    PlanTooLarge,
    StaleRevision,
)
from argo_planner.service.web.access import AccessDenied, TokenMissing
from argo_planner.service.web.problems import RevisionMissing, TooLarge

FINDINGS = (
    Diagnostic(
        code="edit.place",
        severity=Severity.ERROR,
        message="no such place",
        span=Span(line=1, column=2),
        hint="name another",
        remedies=(Remedy.CHECK_MISSION,),
    ),
    Diagnostic(code="edit.value", severity=Severity.ERROR, message="no value"),
)
FILE = (Path("a/b: c.json"), FileProblem.MISSING, "there is none", "name one; or none")
MADE = [
    *(
        kind("what: is it", remedies=(Remedy.RESUME, Remedy.RECORD), about="a.jsonl")
        for kind in (ArgoError, NotFound, Invalid, Unreachable, Conflict, Unavailable)
    ),
    argo_env.closing.CopyRefused("not this one", about="it"),
    DiagnosticError("a.txt", FINDINGS),
    IncompleteDraft(Draft("a.txt", (), None, FINDINGS)),
    *(kind(FINDINGS) for kind in (EditError, EditNotFound, EditInvalid, EditConflict)),
    *(kind(*FILE) for kind in (FileError, MissingFile, UnreadableFile)),
    LimitExceeded("takes longer than 60 s to read"),
    UnwritableRecording(Path("a.mcap"), "No space left on device"),
    *(kind("no") for kind in (CommandIdTaken, NothingToUndo, PlanTooLarge)),
    *(kind("no") for kind in (AccessDenied, TokenMissing, RevisionMissing, TooLarge)),
    StaleRevision(3, 5),
    StaleRevision(3, 5, ()),
    ChangedSince("by bob", FINDINGS),
    EditRefused("no such place", 1, FINDINGS),
    FiledSince("Night round", ""),
    FiledSince("Night round", "Floor 1"),
]


def through_pickle(error):
    return [
        pickle.loads(pickle.dumps(error, protocol))
        for protocol in range(pickle.HIGHEST_PROTOCOL + 1)
    ]


@pytest.mark.parametrize("error", MADE, ids=lambda e: type(e).__name__)
def test_an_error_is_the_same_after_a_pickle_and_a_copy(error):
    error.remedies, error.about = (Remedy.RESUME,), "what it is about"
    error.add_note("seen by a caller")
    for made in (*through_pickle(error), copy.copy(error), copy.deepcopy(error)):
        assert type(made) is type(error)
        assert str(made) == str(error)
        assert made.args == error.args
        assert made.code == error.code
        assert vars(made) == vars(error)


def test_every_kind_of_error_is_looked_at():
    def kinds(kind):
        return {kind, *(k for sub in kind.__subclasses__() for k in kinds(sub))}

    ours = {k for k in kinds(ArgoError) if k.__module__.split(".")[0].startswith("argo_")}
    assert ours == {type(error) for error in MADE}
