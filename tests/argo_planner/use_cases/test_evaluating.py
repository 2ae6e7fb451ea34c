"""Policies of evaluations in modules of a folder."""

from pathlib import Path

import pytest

from argo_compiler.base.errors import Invalid
from argo_planner.use_cases.evaluating import reorder_by_policy
from argo_planner.use_cases.importing import ImportedMission
from tests.yard import measure, mission

IMPORTED = ImportedMission(mission(measure(1)), "plan.json", (), ())
NAMING = "def order(mission, site): return mission.model_copy(update={{'designation': '{}'}})\n"


def chosen_name(folder: Path, policy: str, site) -> str:
    """Return the designation that a policy in a folder gives the mission."""
    return reorder_by_policy(IMPORTED, site, policy, folder).designation


@pytest.mark.parametrize(
    ("module", "files"),
    [
        ("orders_in_file", ["orders_in_file.py"]),
        ("orders_in_package", ["orders_in_package/__init__.py"]),
        ("package.orders", ["package/orders.py", "package/__init__.py"]),
        ("without_init.orders", ["without_init/orders.py"]),
    ],
)
def test_policies_of_one_name_in_two_folders_differ(tmp_path, site, module, files):
    for name in ("1", "2"):
        for file in files:
            path = tmp_path / name / file
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(NAMING.format(name))
    names = [chosen_name(tmp_path / name, f"{module}:order", site) for name in ("1", "2", "1")]
    assert names == ["1", "2", "1"]


def test_a_policy_that_is_changed_is_imported_anew(tmp_path, site):
    for name in ("1", "22"):
        (tmp_path / "changing_orders.py").write_text(NAMING.format(name))
        assert chosen_name(tmp_path, "changing_orders:order", site) == name


def test_a_policy_imports_modules_of_its_folder_when_it_is_called(tmp_path, site):
    (tmp_path / "late_names.py").write_text("NAME = 'late'\n")
    (tmp_path / "late_orders.py").write_text(
        "def order(mission, site):\n"
        "    import late_names\n"
        "    return mission.model_copy(update={'designation': late_names.NAME})\n"
    )
    assert chosen_name(tmp_path, "late_orders:order", site) == "late"


def test_a_folder_without_the_module_does_not_hide_an_installed_package(tmp_path, site):
    (tmp_path / "json").mkdir()
    with pytest.raises(Invalid, match="policy `json:loads`: TypeError"):
        chosen_name(tmp_path, "json:loads", site)
