"""Evaluations from files: what is run is found out and checked before the first run begins."""

import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import cast

from argo_compiler.base.errors import ArgoError, Conflict, Invalid, NotFound, located
from argo_compiler.base.version import __version__
from argo_compiler.files.loading import read_bytes
from argo_compiler.il import Mission
from argo_env.evaluation.case import AS_WRITTEN, NO_FAULTS, EvaluationCase
from argo_env.evaluation.file import DrawnFaults, EvaluationFile, MissionEntry
from argo_env.evaluation.plan import EvaluationPlan, Stopping, parse_seeds
from argo_env.evaluation.pool.backend import WorkerBackend
from argo_env.evaluation.pool.backends import make_backend
from argo_env.evaluation.requirement import parse_requirement
from argo_env.faults.kinds import AnyFault
from argo_env.faults.loading import (
    MAX_BYTES,
    NOTHING,
    FaultDistribution,
    FaultText,
    decode_distribution,
    decode_faults,
)
from argo_env.planning.opening import OpenedSite, open_site
from argo_env.robot.spec import load_robot
from argo_env.run.run_setup import check_spec
from argo_env.run.spec import RunSpec
from argo_env.worker_processes import context_with, usable_processors
from argo_planner.use_cases.importing import ImportedMission, Upload, import_mission
from argo_planner.use_cases.no_order import require_order
from argo_planner.use_cases.routing import suggest_order

OPTIMISED = "optimised"
"""the policy that suggests the best order, as `argo route` does"""
_YAML = (".yaml", ".yml")


@dataclass(frozen=True)
class FaultSet:
    """The faults of a case."""

    name: str
    faults: tuple[AnyFault, ...] = ()
    weight: float = 1.0
    said: FaultText | None = None
    """the text that they were read from"""


def plan_evaluation(
    file: EvaluationFile, folder: Path, read: Callable[[Path], Upload]
) -> EvaluationPlan:
    """All runs that an evaluation's file asks for. Paths in it begin in `folder`; a mission is read
    by `read`.

    Raises ArgoError for what is not there, makes no sense, or can't be run.
    """
    sets = [*_fault_sets(file, folder)]
    cases = [*_cases(file, folder, read, sets)]
    if not cases:
        raise Invalid("nothing is to be run: `faults` is empty; give at least `none`")
    worlds = file.worlds
    for site, robot in {(case.spec.site, case.spec.robot) for case in cases if worlds.values}:
        worlds.check(open_site(site, load_robot(robot)).site)
    if isinstance(file.faults, DrawnFaults) and not file.faults.strata:
        drawn = _distribution(file.faults, folder)
        _require_drawn(cases, drawn, str(folder / file.faults.file))
        worlds = worlds.model_copy(update={"faults": drawn})
    plan = EvaluationPlan(
        name=file.name,
        cases=tuple(cases),
        seeds=parse_seeds(str(file.seeds)),
        variation=worlds,
        stopping=Stopping(
            width=file.stop.width,
            every=file.stop.every,
            require=tuple(parse_requirement(text) for text in file.require),
        ),
        strata=file.strata,
    )
    plan.check()
    return plan


def files_of(file: EvaluationFile, folder: Path) -> Iterator[bytes]:
    """What an evaluation depends on, as far as it is in files: two that give the same are the same
    evaluation. Policies that are functions are not in files, and never the same."""
    yield __version__.encode()
    yield file.model_dump_json().encode()
    if any(policy not in (AS_WRITTEN, OPTIMISED) for policy in file.policies):
        yield os.urandom(16)
    faults = [file.faults.file] if isinstance(file.faults, DrawnFaults) else file.faults
    missions = [said if isinstance(said, str) else said.file for said in file.missions]
    for name in (*missions, *file.sites, *faults):
        path = folder / name
        for one in _files(path) if os.path.isdir(path) else [path]:
            if os.path.isfile(one):
                yield str(one).encode()
                yield one.read_bytes()


def make_workers(
    plan: EvaluationPlan, backend: str, workers: int | None, address: str | None
) -> WorkerBackend:
    """Workers for an evaluation, at most one a run. Raises ArgoError if there can be none."""
    runs = len(plan.seeds) * (1 if plan.strata else len(plan.cases))
    if workers is None and address is None:
        workers = usable_processors()
    if workers is not None:
        workers = min(workers, runs)
    context = context_with("argo_env.evaluation.runner")
    return make_backend(backend, workers, address, context)


def _cases(
    file: EvaluationFile, folder: Path, read: Callable[[Path], Upload], sets: list[FaultSet]
) -> Iterator[EvaluationCase]:
    names: dict[str, str] = {}
    for said in file.missions:
        entry = MissionEntry(file=said) if isinstance(said, str) else said
        name = entry.name or Path(entry.file).stem
        if names.setdefault(name, entry.file) != entry.file:
            raise Conflict(
                f"missions {names[name]} and {entry.file} are both called {name}: give one of them "
                "a name"
            )
        upload = read(folder / entry.file)
        for site in file.sites:
            for robot in file.robots:
                opened = open_site(_site(site, folder), load_robot(robot)).prepare()
                imported = import_mission(upload, opened, entry.start_area, entry.end_area)
                for policy in file.policies:
                    mission = ordered(imported, opened, policy)
                    for drive in file.drives:
                        for sensor in file.sensors:
                            spec = RunSpec(
                                mission=mission,
                                site=opened.reference,
                                robot=robot,
                                drive=drive,
                                sensor=sensor,
                            )
                            for faults in sets:
                                yield case_of(name, policy, spec, faults, opened)


def case_of(
    name: str, policy: str, spec: RunSpec, faults: FaultSet, opened: OpenedSite
) -> EvaluationCase:
    """A case of an evaluation with these faults. Raises ArgoError if no run can have them there."""
    spec = spec.model_copy(update={"faults": faults.faults})
    check_spec(spec, opened.site, faults.said)
    return EvaluationCase(
        mission=name,
        policy=policy,
        faults=faults.name,
        spec=spec,
        digest=opened.digest,
        weight=faults.weight,
    )


def ordered(imported: ImportedMission, site: OpenedSite, policy: str) -> Mission:
    """The mission in the order of a policy: `as written`, `optimised`, or that of a function, named
    as `module:function`, which is given mission and site and returns a mission.

    Raises ArgoError if there is no such policy, or no such order.
    """
    if policy == AS_WRITTEN:
        return imported.mission
    if policy == OPTIMISED:
        found = suggest_order(imported, site)
        require_order(found, imported.source_name)
        return found.mission
    module, colon, name = policy.partition(":")
    if not colon:
        raise NotFound(
            f"no policy `{policy}`; there are: {AS_WRITTEN}, {OPTIMISED}, and functions of your "
            "own as module:function"
        )
    try:
        function = getattr(import_module(module), name)
    except (ImportError, AttributeError) as error:
        raise NotFound(f"policy `{policy}`: {error}") from None
    try:
        mission = cast("object", function(imported.mission, site))
    except Exception as error:  # whatever somebody's own function raises
        raise Invalid(f"policy `{policy}`: {type(error).__name__}: {error}") from error
    if not isinstance(mission, Mission):
        raise Invalid(f"policy `{policy}`: gave {type(mission).__name__}, and no mission")
    return mission


def _fault_sets(file: EvaluationFile, folder: Path) -> Iterator[FaultSet]:
    if isinstance(file.faults, DrawnFaults):
        drawn = _distribution(file.faults, folder)
        if not file.faults.strata:
            yield FaultSet("drawn")
            return
        if drawn.fault_free_probability:
            yield FaultSet(NOTHING, weight=drawn.fault_free_probability)
        for chance in drawn.chances:
            yield FaultSet(chance.name, chance.faults, chance.probability)
        return
    for said in file.faults:
        if said == NO_FAULTS:
            yield FaultSet(NO_FAULTS)
            continue
        path = folder / said
        found = _files(path) if os.path.isdir(path) else [path]
        if not found:
            raise NotFound(f"{path}: has no files of faults, which end in .yaml")
        for one in found:
            text = decode_faults(read_bytes(one, "file of faults", MAX_BYTES), str(one))
            yield FaultSet(one.stem, text.faults, said=text)


def _files(folder: Path) -> list[Path]:
    return sorted(
        folder / name for name in os.listdir(folder) if os.path.splitext(name)[1] in _YAML
    )


def _distribution(said: DrawnFaults, folder: Path) -> FaultDistribution:
    path = folder / said.file
    return decode_distribution(read_bytes(path, "distribution of faults", MAX_BYTES), str(path))


def _site(said: str, folder: Path) -> str:
    """A site's file is looked for beside the evaluation's."""
    path = folder / said
    return str(path) if said.endswith(_YAML) and os.path.isfile(path) else said


def _require_drawn(cases: list[EvaluationCase], drawn: FaultDistribution, file: str) -> None:
    """Raises ArgoError for faults that no run of a case can have, before one draws them."""
    for case in cases:
        site = open_site(case.spec.site, load_robot(case.spec.robot)).site
        for chance in drawn.chances:
            faults = (*case.spec.faults, *chance.faults)
            try:
                check_spec(case.spec.model_copy(update={"faults": faults}), site)
            except ArgoError as error:
                raise located(error, f"{file}: {chance.name}") from None
