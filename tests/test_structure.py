"""Structure of the packages: one direction of imports, no circles, one module for each name."""

import ast
import re
from collections import defaultdict
from functools import cache
from graphlib import CycleError, TopologicalSorter

import pytest

from tests import source
from tests.processes import run_python

KNOWS = {
    "argo_compiler": set(),
    "argo_env": {"argo_compiler"},
    "argo_planner": {"argo_compiler", "argo_env"},
    "baselines": {"argo_compiler", "argo_env"},
}
"""Other packages that each package may import."""
FRONT_DOORS = {"argo_compiler", "argo_env"}


def dotted(path):
    parts = path.with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


@cache
def trees():
    """Return the syntax tree of each module by its dotted name."""
    return {dotted(path): tree for path, tree in source.trees().items()}


@cache
def nodes_of(module):
    """Return all nodes of a module's syntax tree."""
    return tuple(ast.walk(trees()[module]))


PACKAGES = {
    dotted(path.relative_to(source.ROOT))
    for package in KNOWS
    for path in (source.ROOT / package).rglob("__init__.py")
}


@cache
def imports_of(module):
    """Return the modules of the project that a module imports anywhere."""
    found = set()
    for node in nodes_of(module):
        if isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{module} imports relatively"
            for alias in node.names:
                full = f"{node.module}.{alias.name}"
                found.add(full if full in trees() else node.module)
        elif isinstance(node, ast.Import):
            found.update(alias.name for alias in node.names)
    return (found & set(trees())) - {module}


def room_of(module):
    """Return the folder of a module; a module in the root of a package is its own folder."""
    if module in PACKAGES:
        return module
    folder = module.rpartition(".")[0]
    return module if folder in KNOWS else folder


def require_no_circle(imports):
    try:
        list(TopologicalSorter(imports).static_order())
    except CycleError as error:
        pytest.fail(" imports ".join(reversed(error.args[1])))


@pytest.mark.parametrize("package", KNOWS)
def test_packages_import_in_one_direction(package):
    imported = {
        (module, other)
        for module in trees()
        if module.split(".")[0] == package
        for other in imports_of(module)
        if other.split(".")[0] not in {package, *KNOWS[package]}
    }
    assert not imported


def test_folders_import_each_other_in_no_circle():
    rooms = defaultdict(set)
    for module in set(trees()) - FRONT_DOORS:
        for other in imports_of(module) - FRONT_DOORS:
            if room_of(other) != room_of(module):
                rooms[room_of(module)].add(room_of(other))
    require_no_circle(rooms)


def test_files_import_each_other_in_no_circle():
    """Late imports and those for type checkers count, and so does a package's `__init__`."""
    require_no_circle({module: imports_of(module) for module in trees()})


COMPREHENSIONS = ast.ListComp | ast.SetComp | ast.DictComp | ast.GeneratorExp


def run_by(node):
    """Yield the nodes below a node, except those in functions, classes and comprehensions."""
    for child in ast.iter_child_nodes(node):
        yield child
        if not isinstance(child, ast.FunctionDef | ast.ClassDef | ast.Lambda | COMPREHENSIONS):
            yield from run_by(child)


def bound_in(package):
    """Return the names that a package defines or offers, each with the module it may be."""
    for node in run_by(trees()[package]):
        if isinstance(node, ast.ImportFrom):
            yield from ((a.asname or a.name, f"{node.module}.{a.name}") for a in node.names)
        elif isinstance(node, ast.Import):
            yield from ((a.asname or a.name.split(".")[0], a.name) for a in node.names)
        elif isinstance(node, ast.FunctionDef | ast.ClassDef):
            yield node.name, None
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            yield node.id, None
        elif isinstance(node, ast.Call) and ast.unparse(node.func) == "lazy_names":
            homes = ast.literal_eval(node.args[1])
            yield from ((name, None) for names in homes.values() for name in names)


def test_no_name_of_a_package_hides_a_module():
    hidden = [
        f"{package}.{name}"
        for package in PACKAGES & set(trees())
        for name, module in bound_in(package)
        if f"{package}.{name}" in trees() and module != f"{package}.{name}"
    ]
    assert not hidden


IMPORTS = """
import sys
from functools import reduce
from importlib import import_module
from types import ModuleType
for dotted in sys.argv[1:]:
    module = import_module(dotted)
    package, *rest = dotted.split(".")
    found = reduce(getattr, rest, import_module(package))
    if found is not module or not isinstance(module, ModuleType):
        print(dotted)
"""


@pytest.mark.long
def test_each_module_is_found_where_its_name_says():
    """`import a.b.c as x` works, whichever modules have been imported before."""
    modules = sorted(module for module in trees() if not module.endswith(".__main__"))
    said = run_python("-c", IMPORTS, *modules, check=False)
    assert (said.returncode, said.stdout) == (0, ""), said.stderr


def test_the_checkers_of_witnesses_share_no_code_with_the_analysis():
    analysis = "argo_compiler.analysis."
    forms = {analysis + name for name in ("results", "travel", "witness")}
    checkers = {m for m in trees() if m.startswith((analysis + "verif", analysis + "bound_verif"))}
    assert checkers
    for module in checkers:
        others = {other for other in imports_of(module) if other.startswith(analysis)}
        assert others <= forms | checkers, module


@cache
def imported_into(module):
    """Yield the names that a module imports from other modules of the project."""
    return {
        alias.name
        for node in nodes_of(module)
        if isinstance(node, ast.ImportFrom) and node.module in trees()
        for alias in node.names
        if f"{node.module}.{alias.name}" not in trees()
    }


@pytest.mark.parametrize("package", KNOWS)
def test_names_are_imported_from_their_home_or_from_the_package_that_offers_them(package):
    """A module of that package itself imports them from their own module."""
    strays = [
        f"{module} imports {alias.name} from {node.module}, which has it from elsewhere"
        for module in trees()
        if module.split(".")[0] == package
        for node in nodes_of(module)
        if isinstance(node, ast.ImportFrom) and node.module in trees()
        if node.module not in PACKAGES or module.startswith(f"{node.module}.")
        for alias in node.names
        if alias.name in imported_into(node.module)
    ]
    assert not strays


def test_only_packages_offer_what_they_import():
    offered = {
        (module, name)
        for module in set(trees()) - PACKAGES
        for node in trees()[module].body
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "__all__"
        for name in set(ast.literal_eval(node.value)) & imported_into(module)
    }
    assert not offered


def test_each_public_class_has_a_name_of_its_own():
    homes = {}
    for module, tree in trees().items():
        for node in tree.body:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                homes.setdefault(node.name, []).append(module)
    assert not {name: modules for name, modules in homes.items() if len(modules) > 1}


def is_script(module):
    """Return True if a module is a script, which is run and not imported."""
    return module.endswith(".__main__") or any(
        isinstance(node, ast.If) and "__name__" in ast.unparse(node.test)
        for node in trees()[module].body
    )


def test_libraries_do_not_print():
    """Use cases don't print either: commands, the terminal and scripts print for people."""
    prints = {
        module
        for module in trees()
        if not module.startswith(("argo_planner.commands", "argo_planner.terminal"))
        if module != "argo_planner.cli" and not is_script(module)
        for node in nodes_of(module)
        if isinstance(node, ast.Call) and ast.unparse(node.func) in {"print", "sys.stdout.write"}
    }
    assert not prints


def test_no_command_imports_another():
    for module in trees():
        if module.startswith("argo_planner.commands."):
            others = {m for m in imports_of(module) if m.startswith("argo_planner.commands")}
            assert not others, module


def test_use_cases_know_no_terminal():
    for module in trees():
        if module.startswith("argo_planner.use_cases"):
            assert not {
                m
                for m in imports_of(module)
                if m.startswith(("argo_planner.commands", "argo_planner.terminal"))
            }, module
            names = {
                alias.name if isinstance(node, ast.Import) else node.module
                for node in nodes_of(module)
                if isinstance(node, ast.Import | ast.ImportFrom)
                for alias in node.names
            }
            assert not {n for n in names if n.split(".")[0] in {"typer", "rich", "click"}}, module


def texts_of(module):
    """Return the texts in a module but docstrings."""
    docstrings = {
        id(node.value)
        for node in nodes_of(module)
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
    }
    return [
        node.value
        for node in nodes_of(module)
        if isinstance(node, ast.Constant)
        and isinstance(node.value, str)
        and id(node) not in docstrings
    ]


OPTION = re.compile(r"(^|[\s(`])--[a-z]|`argo ")


def test_messages_of_the_libraries_name_the_thing_and_no_option():
    """The command line adds options to messages; scripts of the libraries are command lines."""
    for module in trees():
        library = module.startswith(("argo_compiler", "argo_env", "argo_planner.use_cases"))
        if not library or is_script(module):
            continue
        said = [text for text in texts_of(module) if OPTION.search(text)]
        assert not said, module


FOLDER = re.compile(r"^(?!<!--).*(?<![\w/])(?:benchmarks|docs|scenarios|tests|urdf)/\w")


def test_messages_name_no_folder_that_only_a_checkout_has():
    """The pages of `docs/` are read with `argo docs`, and the scenarios with `argo examples`."""
    for module in trees():
        if not is_script(module):
            said = [text for text in texts_of(module) if FOLDER.search(text)]
            assert not said, module


@pytest.mark.parametrize("package", KNOWS)
def test_what_goes_wrong_is_of_a_kind(package):
    """`ArgoError` is the base class; a program can't react to it alone."""
    bare = [
        f"{module}, line {node.lineno}"
        for module in trees()
        if module.split(".")[0] == package
        for node in nodes_of(module)
        if isinstance(node, ast.Call)
        and isinstance(node.func, ast.Name)
        and node.func.id == "ArgoError"
    ]
    assert not bare


SHIPPED = {
    "argo_compiler.base.saved_tables",
    "argo_env.files.resources",
    "argo_env.planning.code",
}
"""Modules that ask only for files that Argo has made itself."""


def test_paths_of_users_are_asked_for_by_what_never_raises():
    """Unlike `os.path`, a `Path` raises if a folder can't be read or links form a circle."""
    asking = {
        module
        for module in trees()
        for node in nodes_of(module)
        if isinstance(node, ast.Call)
        and isinstance(node.func, ast.Attribute)
        and node.func.attr in {"exists", "is_file", "is_dir", "resolve"}
        and ast.unparse(node.func.value) != "os.path"
    }
    assert {module for module in asking if not module.startswith("baselines")} == SHIPPED


def test_all_yaml_goes_through_one_reader_and_writer():
    """PyYAML alone reads `010` as 8 and `1:30` as 90."""
    using = {
        module
        for module in trees()
        for node in nodes_of(module)
        if (isinstance(node, ast.Import) and "yaml" in {name.name for name in node.names})
        or (isinstance(node, ast.ImportFrom) and node.module == "yaml")
    }
    assert using == {"argo_compiler.files.yaml_text"}
