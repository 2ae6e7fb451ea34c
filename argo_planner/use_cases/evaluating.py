"""Plans of evaluations, whose runs are all checked before the first one begins."""

import os
from collections.abc import Callable, Iterator
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import cast

from argo_compiler.base.errors import ArgoError, Conflict, Invalid, NotFound, with_message_prefix
from argo_compiler.base.extensions import installed_names, installed_packages
from argo_compiler.base.message import Message
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
from argo_env.policies import OPTIMISED, POLICIES, import_policy, modules_of_policy_in
from argo_env.robot.spec import load_robot
from argo_env.run.run_setup import check_spec
from argo_env.run.spec import RunSpec
from argo_env.worker_processes import context_with, usable_processors
from argo_planner.use_cases.importing import ImportedMission, Upload, import_mission
from argo_planner.use_cases.no_order import require_order
from argo_planner.use_cases.routing import suggest_order

_YAML = (".yaml", ".yml")


@dataclass(frozen=True)
class FaultSet:
    """The faults of a case, with their name."""

    name: str
    faults: tuple[AnyFault, ...] = ()
    weight: float = 1.0
    text: FaultText | None = None
    """file that they were read from; None: they were drawn, or there are none"""


def plan_evaluation(
    file: EvaluationFile,
    folder: Path,
    read: Callable[[Path], Upload],
    policy_folder: Path | None = None,
) -> EvaluationPlan:
    """Return the plan with all runs that an evaluation file asks for.

    Args:
        file: the evaluation
        folder: folder that the paths in the file are relative to
        read: function that reads the file of a mission
        policy_folder: folder whose modules may have policies, which are code that is run; None:
            only installed modules may

    Raises:
        ArgoError: A file is missing or has errors, or a run is not possible.
    """
    sets = [*_fault_sets(file, folder)]
    cases = [*_cases(file, folder, read, sets, policy_folder)]
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
        strata=file.is_stratified,
    )
    plan.check()
    return plan


def contents_for_digest(file: EvaluationFile, folder: Path) -> Iterator[bytes]:
    """Yield the contents of all that an evaluation depends on, from which a digest is computed.

    Equal contents mean equal evaluations: the versions of Argo and of the packages that extend it,
    the evaluation file, and the files that it names.

    A policy that is a function is not in a file; random bytes stand for it, so that evaluations
    with it are never equal.
    """
    yield "\n".join((__version__, *installed_packages())).encode()
    yield file.model_dump_json().encode()
    if any(policy not in (AS_WRITTEN, OPTIMISED) for policy in file.policies):
        yield os.urandom(16)
    faults = [file.faults.file] if isinstance(file.faults, DrawnFaults) else file.faults
    missions = [one if isinstance(one, str) else one.file for one in file.missions]
    for name in (*missions, *file.sites, *faults):
        path = folder / name
        for one in _files(path) if os.path.isdir(path) else [path]:
            if os.path.isfile(one):
                yield str(one).encode()
                yield one.read_bytes()


def make_workers(
    plan: EvaluationPlan, backend: str, workers: int | None, address: str | None
) -> WorkerBackend:
    """Return a back end whose workers can carry out the evaluation.

    Args:
        plan: the evaluation
        backend: name of the back end
        workers: number of workers, reduced to the number of runs if that is smaller; None: as many
            as processors, reduced likewise, or all of the cluster at `address`
        address: address of a running cluster; None: the workers run on this machine

    Raises:
        ArgoError: There is no such back end, or it can't be started.
    """
    runs = len(plan.seeds) * (1 if plan.strata else len(plan.cases))
    if workers is None and address is None:
        workers = usable_processors()
    if workers is not None:
        workers = min(workers, runs)
    context = context_with("argo_env.evaluation.runner")
    return make_backend(backend, workers, address, context)


def _cases(
    file: EvaluationFile,
    folder: Path,
    read: Callable[[Path], Upload],
    sets: list[FaultSet],
    policy_folder: Path | None,
) -> Iterator[EvaluationCase]:
    names: dict[str, str] = {}
    for mission_file in file.missions:
        entry = MissionEntry(file=mission_file) if isinstance(mission_file, str) else mission_file
        name = entry.name or Path(entry.file).stem
        if names.setdefault(name, entry.file) != entry.file:
            raise Conflict(
                Message(
                    "missions {name} and {file} are both called {name_2}: give one of them "
                    "another name",
                    name=names[name],
                    file=entry.file,
                    name_2=name,
                )
            )
        upload = read(folder / entry.file)
        for site in file.sites:
            for robot in file.robots:
                opened = open_site(_site(site, folder), load_robot(robot)).prepare()
                imported = import_mission(upload, opened, entry.start_area, entry.end_area)
                for policy in file.policies:
                    mission = reorder_by_policy(imported, opened, policy, policy_folder)
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
                                yield make_case(name, policy, spec, faults, opened)


def make_case(
    name: str, policy: str, spec: RunSpec, faults: FaultSet, opened: OpenedSite
) -> EvaluationCase:
    """Return the case of mission `name` with these faults; raise ArgoError if they do not fit."""
    spec = spec.model_copy(update={"faults": faults.faults})
    check_spec(spec, opened.site, faults.text)
    return EvaluationCase(
        mission=name,
        policy=policy,
        faults=faults.name,
        spec=spec,
        digest=opened.digest,
        weight=faults.weight,
    )


def reorder_by_policy(
    imported: ImportedMission, site: OpenedSite, policy: str, folder: Path | None = None
) -> Mission:
    """Return the mission with its tasks in the order that a policy chooses.

    Args:
        imported: the mission
        site: its site
        policy: `as written`, `optimised`, the name of an installed package's policy, or
            `module:function`: a function that takes mission and site, and returns a mission
        folder: folder whose modules come before installed ones

    Raises:
        ArgoError: There is no such policy, or it fails, or no order is possible.
    """
    if policy == AS_WRITTEN:
        return imported.mission
    if policy == OPTIMISED:
        found = suggest_order(imported, site)
        require_order(found, imported.source_name)
        return found.mission
    with modules_of_policy_in(folder, policy) if folder and ":" in policy else nullcontext():
        function = _find_order_function(policy)
        try:
            mission = function(imported.mission, site)
        except Exception as error:  # a user's function may raise anything
            raise Invalid(
                Message(
                    "policy `{policy}`: {name}: {error}",
                    policy=policy,
                    name=type(error).__name__,
                    error=error,
                )
            ) from error
    if not isinstance(mission, Mission):
        raise Invalid(
            Message(
                "policy `{policy}`: returned {name} instead of a mission",
                policy=policy,
                name=type(mission).__name__,
            )
        )
    return mission


def _find_order_function(policy: str) -> Callable[[Mission, OpenedSite], object]:
    """Return the function that orders the tasks by a policy, neither as written nor optimised.

    Raises NotFound if there is none, Unavailable if an installed package's can't be used.
    """
    if ":" in policy:
        return cast("Callable[..., object]", import_policy(policy))
    if policy not in POLICIES:
        others = "".join(f", {name}" for name in installed_names(POLICIES.group))
        raise NotFound(
            Message(
                "no policy `{policy}`; there are: {as_written}, {optimised}{others}, and "
                "functions of your own as module:function",
                policy=policy,
                as_written=AS_WRITTEN,
                optimised=OPTIMISED,
                others=others,
            )
        )
    function = getattr(POLICIES[policy], "order_tasks", None)
    if function is None:
        raise NotFound(
            Message(
                "the policy `{policy}` plays episodes of argo/Route-v0, but does not order "
                "the tasks of missions: it has no `order_tasks`",
                policy=policy,
            )
        )
    return cast("Callable[..., object]", function)


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
    for fault_file in file.faults:
        if fault_file == NO_FAULTS:
            yield FaultSet(NO_FAULTS)
            continue
        path = folder / fault_file
        found = _files(path) if os.path.isdir(path) else [path]
        if not found:
            raise NotFound(Message("{path} contains no files of faults (.yaml)", path=path))
        for one in found:
            text = decode_faults(read_bytes(one, Message("file of faults"), MAX_BYTES), str(one))
            yield FaultSet(one.stem, text.faults, text=text)


def _files(folder: Path) -> list[Path]:
    return sorted(
        folder / name for name in os.listdir(folder) if os.path.splitext(name)[1] in _YAML
    )


def _distribution(drawn: DrawnFaults, folder: Path) -> FaultDistribution:
    path = folder / drawn.file
    return decode_distribution(
        read_bytes(path, Message("distribution of faults"), MAX_BYTES), str(path)
    )


def _site(name: str, folder: Path) -> str:
    """Return the path of the site's file `name` in a folder; `name` itself without such a file."""
    path = folder / name
    return str(path) if name.endswith(_YAML) and os.path.isfile(path) else name


def _require_drawn(cases: list[EvaluationCase], drawn: FaultDistribution, file: str) -> None:
    """Raise ArgoError if faults that may be drawn are not possible in a case."""
    for case in cases:
        site = open_site(case.spec.site, load_robot(case.spec.robot)).site
        for chance in drawn.chances:
            faults = (*case.spec.faults, *chance.faults)
            try:
                check_spec(case.spec.model_copy(update={"faults": faults}), site)
            except ArgoError as error:
                raise with_message_prefix(error, f"{file}: {chance.name}") from None
