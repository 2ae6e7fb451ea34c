"""The words of the code: how docstrings begin, and that a function's name has one meaning."""

import ast
import re
import tomllib
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

from tests.processes import ROOT

FOLDERS = ("argo_compiler", "argo_env", "argo_planner", "baselines", "benchmarks", "tests", ".ci")
RIDDLE = re.compile(
    r'^ *r?"""(?:What|How|Where|Whether|Which|Who|Why|Of|One|None|That|Those)\b.*', re.MULTILINE
)
"""a docstring whose first word leaves open what it describes"""
RUFF = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["ruff"]["lint"]
UNFINISHED = tuple(
    pattern.removesuffix("**")
    for pattern, rules in RUFF["per-file-ignores"].items()
    if "D4" in rules
)
"""folders whose docstrings are still to be put into plain words"""


def test_no_docstring_begins_with_a_riddle():
    """This includes docstrings of attributes and constants."""
    riddles = [
        f"{path.relative_to(ROOT)}: {found.group().strip()}"
        for folder in FOLDERS
        for path in sorted((ROOT / folder).rglob("*.py"))
        if "node_modules" not in path.parts
        and not path.relative_to(ROOT).as_posix().startswith(UNFINISHED)
        for found in RIDDLE.finditer(path.read_text(encoding="utf-8"))
    ]
    assert not riddles, "\n".join(["say what it is or does:", *riddles])


PACKAGES = ("argo_compiler", "argo_env", "argo_planner", "baselines", "benchmarks")
PROPERTIES = {"property", "cached_property", "thread_safe_cached_property"}
"""decorators of properties"""
OTHER_ROOMS = {
    "argo_compiler/export/flexbe_states": "templates, which run in another program",
    "argo_planner/commands": "a command may be named after the operation that it offers",
    "argo_planner/service/web": "a request handler may be named after the operation that it offers",
}
"""folders whose functions may have the names of others, with the reason"""
SHARED_NAMES = {
    "act": "choose the next action for an observation",
    "advance": "let time or steps pass",
    "apply": "make a change take effect",
    "check": "raise or report what is wrong with the object",
    "checkpoint": "look up a checkpoint by its id",
    "create": "create a mission plan",
    "draw": "draw a random value",
    "execute": "carry out a command",
    "find": "look up by a key",
    "floor": "look up a floor by its number",
    "follow": "follow a path (drives)",
    "from_navigator": "make the object from a navigator",
    "get_attr": "Gymnasium's and Stable-Baselines3's API of vector environments",
    "handle": "process an event or a command",
    "main": "entry point of a command",
    "open": "make ready for use",
    "pose_at": "return the pose at a moment of a motion",
    "prepare": "compute in advance what later calls share",
    "receive": "return the messages that have arrived",
    "reset": "set to a start state",
    "restore": "set to a state that was saved before",
    "resume": "continue what was paused or interrupted",
    "revert": "undo a change",
    "run": "carry out to the end",
    "start": "begin an action, a machine or a job",
    "start_pose": "return the pose at which a mission starts",
    "step": "let one time step pass",
    "submit": "call a function in a worker process",
    "successors": "return the states that follow in a graph",
    "update": "process the newest values",
    "write": "write text or bytes, as files do",
}
"""meanings of the function names that may have several return types"""


def public_functions(path: Path) -> Iterator[tuple[str, str]]:
    """Yield names and return types of a file's functions and of its public classes' methods."""
    bodies = [ast.parse(path.read_text(encoding="utf-8")).body]
    while bodies:
        for node in bodies.pop():
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                bodies.append(node.body)
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                decorators = {ast.unparse(decorator) for decorator in node.decorator_list}
                is_attribute = decorators & {
                    "property",
                    "cached_property",
                    "thread_safe_cached_property",
                    f"{node.name}.setter",
                }
                if not node.name.startswith("_") and not is_attribute:
                    returned = ast.unparse(node.returns) if node.returns else ""
                    yield node.name, returned.strip("'")


def test_a_function_name_has_one_meaning():
    """Functions of one name in several folders have one return type, or are listed above."""
    rooms, types = defaultdict(set), defaultdict(set)
    for package in PACKAGES:
        for path in sorted((ROOT / package).rglob("*.py")):
            room = path.relative_to(ROOT).parent.as_posix()
            if "node_modules" in path.parts or f"{room}/".startswith((*UNFINISHED, *OTHER_ROOMS)):
                continue
            for name, returned in public_functions(path):
                rooms[name].add(room)
                types[name].add(returned)
    shared = {name for name in types if len(rooms[name]) > 1 and len(types[name]) > 1}
    unlisted = [
        f"{name}: {', '.join(sorted(rooms[name]))}" for name in shared - SHARED_NAMES.keys()
    ]
    assert not unlisted, "\n".join(["choose names that say more:", *sorted(unlisted)])
    assert not SHARED_NAMES.keys() - shared, "remove these from SHARED_NAMES"
