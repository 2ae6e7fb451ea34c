"""`argo doctor`: its output about the installation, and the option `--empty-cache`."""

import platform
import tomllib
from importlib.util import find_spec
from pathlib import Path

import pytest

import argo_planner.use_cases.doctor
from argo_compiler import __version__
from argo_compiler.base.extras import install_line
from argo_env.files import cache
from argo_env.planning.opening import forget_sites, open_site
from argo_planner.use_cases.doctor import examine_installation
from tests.argo_planner.conftest import argo

PROJECT = Path(__file__).parents[2] / "pyproject.toml"


def doctor(*arguments):
    return argo("doctor", *arguments, status=0).output


@pytest.mark.physics
def test_what_it_shows(tmp_path, monkeypatch):
    monkeypatch.setenv(cache.VARIABLE, str(tmp_path))
    forget_sites()
    assert f"cache: {tmp_path}, 0 sites, 0.0 MB" in doctor()
    assert open_site("darmstadt").catalog
    said = doctor()
    assert said.startswith(f"argo {__version__}, Python {platform.python_version()}")
    size = sum(path.stat().st_size for path in tmp_path.rglob("*") if path.is_file())
    assert f"cache: {tmp_path}, 1 sites, {size / 1e6:.1f} MB of at most" in said
    assert "PyBullet: works" in said
    emptied = doctor("--empty-cache")
    assert f"cache: emptied, {size / 1e6:.1f} MB freed" in emptied
    assert f"cache: {tmp_path}, 0 sites, 0.0 MB" in emptied
    assert not [path for path in tmp_path.rglob("*") if path.is_file()]


def test_missing_extras_are_shown_with_their_install_command(monkeypatch):
    def without(name):
        return None if name in {"cv2", "mcap"} else find_spec(name)

    monkeypatch.setattr(argo_planner.use_cases.doctor, "find_spec", without)
    said = doctor()
    assert "vision (reading gauges from pictures): not installed, cv2; pip install" in said
    assert "recording (recordings of runs): not installed, mcap; pip install" in said
    assert install_line("vision") in said


def test_a_folder_that_can_not_be_used_is_named_with_the_reason(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("", encoding="utf-8")
    monkeypatch.setenv(cache.VARIABLE, str(tmp_path / "file"))
    assert "nothing can be stored there, so each command computes its site again: " in doctor()
    assert examine_installation().cache.write_problem == "Not a directory"
    refused = argo("doctor", "--empty-cache")
    assert "the cache can't be emptied: Not a directory; set" in str(refused.exception)
    assert "emptied, " not in refused.output


def test_an_empty_variable_names_no_folder(monkeypatch):
    monkeypatch.delenv(cache.VARIABLE)
    usual = cache.cache_folder()
    monkeypatch.setenv(cache.VARIABLE, "")
    assert cache.cache_folder() == usual


def test_all_extras_for_users_are_looked_at():
    extras = tomllib.loads(PROJECT.read_text("utf-8"))["project"]["optional-dependencies"]
    assert {extra.name for extra in examine_installation().extras} == set(extras) - {"bench", "dev"}
