"""Installation of Argo's optional parts (extras)."""

import json
from pathlib import Path

PROJECT = "argo-mission"


def install_line(extra: str) -> str:
    """Return the `pip install` command that adds an extra to Argo, for messages.

    The command installs from the source from which Argo itself was installed: an index may not have
    Argo, or may have something else under its name.
    """
    import shlex

    return shlex.join(("pip", "install", *_source(extra)))


def _source(extra: str) -> tuple[str, ...]:
    """Return the arguments with which `pip install` installs Argo and the extra."""
    # Imported late: they take long to import, and are rarely needed.
    from importlib.metadata import PackageNotFoundError, distribution
    from urllib.parse import urlsplit
    from urllib.request import url2pathname

    try:
        origin = distribution(PROJECT).read_text("direct_url.json")  # PEP 610
    except PackageNotFoundError:
        return _checkout(Path(__file__).parents[2], extra)
    if origin is None:
        return (f"{PROJECT}[{extra}]",)
    info = json.loads(origin)
    url = info["url"]
    if "dir_info" in info:
        folder = Path(url2pathname(urlsplit(url).path))
        return _checkout(folder, extra, info["dir_info"].get("editable", False))
    if "vcs_info" in info:
        url = f"{info['vcs_info']['vcs']}+{url}@{info['vcs_info']['commit_id']}"
    return (f"{PROJECT}[{extra}] @ {url}",)


def _checkout(folder: Path, extra: str, editable: bool = True) -> tuple[str, ...]:
    return (*(("-e",) if editable else ()), f"{folder}[{extra}]")
