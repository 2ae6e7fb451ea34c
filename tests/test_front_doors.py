"""Names that packages offer before their modules are imported.

`argo_compiler` and `argo_env` are the front doors; other packages are made in the same way.
"""

import ast
import importlib
import re

import pytest

from tests.processes import ROOT, run_python

DOORS = ("argo_compiler", "argo_env")
LAZY = sorted(
    ".".join(path.relative_to(ROOT).parent.parts)
    for door in DOORS
    for path in (ROOT / door).rglob("__init__.py")
    if "lazy_names(" in path.read_text(encoding="utf-8")
)


def imported_for_type_checkers(package: str) -> dict[str, str]:
    """Return the module of each name, as type checkers and editors see it."""
    path = ROOT.joinpath(*package.split("."), "__init__.py")
    tree = ast.parse(path.read_text(encoding="utf-8"))
    (told,) = (
        node
        for node in tree.body
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
    )
    return {
        alias.name: node.module or ""
        for node in told.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }


@pytest.mark.parametrize("package", LAZY)
def test_each_name_is_what_type_checkers_are_told(package):
    offering = importlib.import_module(package)
    told = imported_for_type_checkers(package)
    assert sorted(told) == offering.__all__
    assert set(offering.__all__) <= set(dir(offering))
    for name, module in told.items():
        assert getattr(offering, name) is getattr(importlib.import_module(module), name)


@pytest.mark.parametrize("package", LAZY)
def test_what_is_not_there_is_said_so(package):
    with pytest.raises(AttributeError, match=f"module '{package}' has no attribute 'nothing'"):
        importlib.import_module(package).nothing  # noqa: B018


@pytest.mark.parametrize("door", DOORS)
def test_importing_it_imports_no_library(door):
    loaded = set(run_python("-c", f"import {door}, sys; print(*sys.modules)").stdout.split())
    assert not loaded & {"numpy", "scipy", "pydantic", "lark", "ortools", "gymnasium", "pybullet"}


@pytest.mark.parametrize(
    "program",
    [
        "import gymnasium\nimport argo_env",
        "import argo_env\nimport gymnasium",
        "import argo_env\nfrom gymnasium.envs import registration\nimport gymnasium",
        "import gymnasium\nimport argo_env\nimport importlib\nimportlib.reload(argo_env)",
    ],
)
def test_gymnasium_knows_the_environments_whichever_is_imported_first(program):
    made = "print(gymnasium.make('argo/Route-v0').spec.id, gymnasium.__loader__.get_filename())"
    id, file = run_python("-c", f"{program}\n{made}").stdout.split()
    assert id == "argo/Route-v0"
    assert file.endswith("__init__.py")


def test_gymnasium_can_be_looked_for_without_being_imported():
    asked = "import argo_env, importlib.util, sys\nimportlib.util.find_spec('gymnasium')"
    assert run_python("-c", f"{asked}\nprint('gymnasium' in sys.modules)").stdout.strip() == "False"


def test_the_readme_imports_from_the_front_doors_only():
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    snippets = re.findall(r"^```python\n(.*?)^```", text, re.M | re.S)
    imported = {
        module
        for snippet in snippets
        for node in ast.walk(ast.parse(snippet))
        for module in (
            [node.module]
            if isinstance(node, ast.ImportFrom)
            else [alias.name for alias in node.names]
            if isinstance(node, ast.Import)
            else []
        )
        if module and module.startswith("argo")
    }
    assert imported == set(DOORS)
