"""README and docs: snippets work unchanged, and the pages of `docs/` need no clone or say so."""

import re
from pathlib import Path

import pytest
import yaml

from argo_env.evaluation.file import decode_evaluation
from argo_env.faults.loading import decode_distribution, decode_faults
from argo_env.planning import OpenedSite
from argo_env.site import make_site
from argo_env.site.site_file import parse_site_spec
from argo_planner.use_cases.examples import example_files
from argo_planner.use_cases.routing import parse_requirements
from argo_planner.use_cases.sites import make_site_report

ROOT = Path(__file__).parents[1]
PAGES = {
    path.relative_to(ROOT).as_posix(): path.read_text(encoding="utf-8")
    for path in (
        ROOT / "README.md",
        ROOT / "CONTRIBUTING.md",
        ROOT / "SECURITY.md",
        *sorted((ROOT / "docs").rglob("*.md")),
    )
}
"""texts of the pages, by their names"""


def snippets(language):
    """Return the snippets of a language by page."""
    fence = re.compile(rf"^```{language}\n(.*?)^```", re.M | re.S)
    by_page = {page: fence.findall(text) for page, text in PAGES.items()}
    return {page: parts for page, parts in by_page.items() if parts}


PYTHON, YAML = snippets("python"), snippets("yaml")
LEARNED = {"docs/environments.md", "docs/policies-learned.md"}
"""pages whose snippets need the extra `learned`"""


@pytest.mark.parametrize("page", PYTHON)
@pytest.mark.long
def test_snippets_run(page, tmp_path, monkeypatch):
    """The snippets of a page run one after the other, beside the examples that the page copies."""
    if page in LEARNED:
        pytest.importorskip("sb3_contrib", reason="needs the extra `learned`")
    for example in re.findall(r"argo examples copy ([a-z]\w*)", PAGES[page]):
        for name, content in example_files(example).items():
            (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
            (tmp_path / name).write_bytes(content)
    monkeypatch.chdir(tmp_path)
    names = {"__name__": "snippet"}
    for number, snippet in enumerate(PYTHON[page], start=1):
        exec(compile(snippet, f"{page}, snippet {number}", "exec"), names)


def is_a_site(text, page):
    report = make_site_report(OpenedSite.from_site(make_site(parse_site_spec(text, page))))
    assert (report.errors, report.notes) == ((), ())


READERS = {
    "docs/diagnostics.md": lambda text, _page: yaml.safe_load(text),  # steps of somebody's CI
    "docs/evaluating.md": lambda text, page: decode_evaluation(text.encode(), page),
    "docs/faults.md": lambda text, page: decode_faults(text.encode(), page),
    "docs/routes.md": lambda text, page: parse_requirements(text.encode(), page),
    "docs/sites.md": is_a_site,
}


@pytest.mark.parametrize("page", YAML)
def test_yaml_snippets_are_accepted(page):
    """The snippets of a page are read as one file."""
    READERS[page]("".join(YAML[page]), page)


def test_the_distribution_of_faults_is_accepted():
    (text,) = snippets("yml")["docs/evaluating.md"]
    assert len(decode_distribution(text.encode(), "docs/evaluating.md").chances) == 2


LINK = re.compile(r"(!?)\[[^]]*\]\(([^)#\s]+)[^)]*\)")
"""a link or a picture, with its target"""
CLONE_ONLY = re.compile(
    r"(?:^|`)make \w+|pip install -e|\bpytest\b|\b(?:benchmarks|examples|scenarios|tests)[./]\w+",
    re.M,
)
"""commands and files that only a clone has, or has elsewhere than a wheel"""


def test_links_lead_to_files():
    missing = [
        f"{page}: {target}"
        for page, text in PAGES.items()
        for _, target in LINK.findall(text)
        if "://" not in target and not (ROOT / page).parent.joinpath(target).exists()
    ]
    assert not missing


def is_in_the_wheel(path):
    """Return True if a wheel has the file or folder at the same place beside the pages."""
    folder = path.relative_to(ROOT).parts[0]
    return folder in {"scenarios", "urdf"} or (
        folder == "docs" and (path.is_dir() or path.suffix == ".md")
    )


def test_links_of_docs_lead_to_files_that_the_wheel_has():
    """Pictures are the exception: their texts say what they show."""
    missing = [
        f"{page}: {target}"
        for page, text in PAGES.items()
        if page.startswith("docs/")
        for picture, target in LINK.findall(text)
        if not picture
        and "://" not in target
        and not is_in_the_wheel((ROOT / page).parent.joinpath(target).resolve())
    ]
    assert not missing


def test_docs_say_what_needs_a_clone():
    """The section or the beginning of the page says it; decision records are for contributors."""
    silent = []
    for page, text in PAGES.items():
        if not re.fullmatch(r"docs/[\w-]+\.md", page):
            continue
        beginning, *sections = re.split(r"^## ", LINK.sub("", text), flags=re.M)
        for section in (beginning, *sections):
            said = "in a clone" in " ".join(f"{beginning} {section}".lower().split())
            silent += [] if said else [f"{page}: {part}" for part in CLONE_ONLY.findall(section)]
    assert not silent


WITH_TABLES = {"docs/diagnostics.md", "docs/drafts.md", "docs/script.md"}
"""pages with wide tables"""
MAX_WIDTH = 120
"""characters of a line"""


def test_lines_of_pages_are_short():
    """Code and the tables of some pages may be wider."""
    code = re.compile(r"^ *```.*?^ *```", re.M | re.S)
    long_lines = [
        f"{page}: {line}"
        for page, text in PAGES.items()
        for line in code.sub("", text).splitlines()
        if len(line) > MAX_WIDTH and not (page in WITH_TABLES and line.startswith("|"))
    ]
    assert not long_lines
