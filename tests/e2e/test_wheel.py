"""Source distribution and wheel: what they hold, and Argo installed outside the checkout."""

import os
import re
import subprocess
import sys
import tarfile
import zipfile
from email import message_from_bytes
from pathlib import Path
from typing import NamedTuple

import pytest

ROOT = Path(__file__).parents[2]
PACKAGES = ("argo_compiler", "argo_env", "argo_planner", "baselines")
DATA = {"docs": "**/*.md", "scenarios": "**/*", "urdf": "**/*"}
"""folders that a wheel has in `argo_env/data`, with the files that it takes from each"""

pytestmark = pytest.mark.long  # building takes several seconds, installing more


class Distributions(NamedTuple):
    """Built files: paths of the source distribution and of both wheels."""

    source: Path
    wheel: Path
    wheel_from_source: Path


def call(*arguments: object, cwd: Path) -> str:
    ours = {"PYTHONPATH", "PYTHONPYCACHEPREFIX", "VIRTUAL_ENV"}
    environment = {k: v for k, v in os.environ.items() if k not in ours}
    result = subprocess.run(
        [str(a) for a in arguments],
        cwd=cwd,
        env=environment,
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    assert result.returncode == 0, result.stdout + result.stderr
    return result.stdout


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Distributions:
    folder = tmp_path_factory.mktemp("built")
    build = (sys.executable, "-m", "build", "--no-isolation", ROOT, "--outdir")
    call(*build, folder / "source", cwd=folder)  # the wheel is built from the source distribution
    call(*build, folder / "checkout", "--wheel", cwd=folder)
    (source,) = (folder / "source").glob("*.tar.gz")
    (wheel,) = (folder / "checkout").glob("*.whl")
    return Distributions(source, wheel, folder / "source" / wheel.name)


def contents(wheel: Path) -> dict[str, bytes]:
    """Return the contents of a wheel's files by their names."""
    with zipfile.ZipFile(wheel) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def files_of(folder: Path, pattern: str = "**/*") -> dict[str, bytes]:
    """Return the contents of a folder's files by their paths in the folder."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in folder.glob(pattern)
        if path.is_file() and "__pycache__" not in path.parts
    }


def test_the_wheel_holds_the_packages_their_data_and_the_pages(built: Distributions) -> None:
    expected = {
        f"{package}/{name}": content
        for package in PACKAGES
        for name, content in files_of(ROOT / package).items()
        if package != "argo_planner" or not name.startswith("page/") or name.startswith("page/dist")
    }
    for folder, pattern in DATA.items():
        files = files_of(ROOT / folder, pattern).items()
        expected |= {f"argo_env/data/{folder}/{name}": content for name, content in files}
    assert "argo_planner/page/dist/index.html" in expected
    found = contents(built.wheel)
    assert {n: c for n, c in found.items() if ".dist-info/" not in n} == expected


def test_a_wheel_from_the_source_distribution_equals_one_from_the_checkout(
    built: Distributions,
) -> None:
    assert contents(built.wheel_from_source) == contents(built.wheel)


def test_the_source_distribution_holds_what_a_reader_needs(built: Distributions) -> None:
    with tarfile.open(built.source) as archive:
        names = {member.name.partition("/")[2] for member in archive.getmembers()}
    needed = {"README.md", "CHANGELOG.md", "CITATION.cff", "SECURITY.md", "LICENSE", "Makefile"}
    needed.add("constraints.txt")
    needed |= {f"docs/{name}" for name in files_of(ROOT / "docs")}
    assert needed <= names


def test_an_index_accepts_both_distributions(built: Distributions) -> None:
    call(sys.executable, "-m", "twine", "check", "--strict", *built, cwd=built.source.parent)


def checkout_parts(text: str) -> list[str]:
    """Return the parts of a page that work in a checkout only: links, pictures, files, commands."""
    targets = re.findall(r"\]\(([^)]*)\)|^\[[^]]*\]: *(\S+)", text, re.M)
    links = [link for target in targets for link in target if link]
    paths = re.findall(r"\.?\w[\w-]*(?:[./]\w[\w-]*)+", text)
    return [
        *(link for link in links if not link.startswith(("https://", "#"))),
        *re.findall(r"!\[|<img", text),
        *(path for path in paths if (ROOT / path).exists()),
        *re.findall(r"(?:^|`)make \w+|pip install -e", text, re.M),
    ]


def test_the_long_description_needs_no_checkout(built: Distributions) -> None:
    files = contents(built.wheel)
    (metadata,) = (content for name, content in files.items() if name.endswith("/METADATA"))
    description = message_from_bytes(metadata).get_payload(decode=True)
    assert isinstance(description, bytes)
    assert description
    assert checkout_parts(description.decode()) == []
    assert len(checkout_parts((ROOT / "README.md").read_text(encoding="utf-8"))) > 50


def test_a_mission_runs_from_the_wheel(
    tmp_path: Path, missions: Path, built: Distributions
) -> None:
    uv = Path(sys.executable).with_name("uv")
    call(uv, "venv", "--quiet", "--python", sys.executable, tmp_path / "venv", cwd=tmp_path)
    python = tmp_path / "venv" / "bin" / "python"
    install = (uv, "pip", "install", "--quiet", "--python", python)
    install += ("--constraint", ROOT / "constraints.txt")
    call(*install, built.wheel, cwd=tmp_path)
    away = tmp_path / "away"
    away.mkdir()
    (away / "script.txt").write_bytes((missions / "mission_1.txt").read_bytes())
    argo = tmp_path / "venv" / "bin" / "argo"
    output = call(
        argo, "run", "script.txt", "--site", "umad", "--start-area", 1, "--end-area", 1,
        "--report", "report", cwd=away,
    )  # fmt: skip
    assert "Success" in output
    assert (away / "report" / "report.html").is_file()
    assert call(argo, "docs", "routes", cwd=away).startswith("# Routes\n")
    page = "from argo_planner.service.web.page import page_folder_path as f; print(*f().glob('*'))"
    call(*install, f"{built.wheel}[planner]", cwd=tmp_path)
    assert "index.html" in call(python, "-c", page, cwd=away)
    location = call(python, "-c", "import argo_env; print(argo_env.__file__)", cwd=away)
    assert str(tmp_path) in location
