"""How the optional parts of Argo are installed."""

import json
from pathlib import Path

PROJECT = "argo-mission"


def install_line(extra: str) -> str:
    """The command that adds an extra to Argo, from where Argo itself was installed: no index need
    have it, or have the same under its name."""
    import shlex

    return shlex.join(("pip", "install", *_source(extra)))


def _source(extra: str) -> tuple[str, ...]:
    """Return the arguments of `pip install`."""
    # Most who import this have all they need, and these take long to import.
    from importlib.metadata import PackageNotFoundError, distribution
    from urllib.parse import urlsplit
    from urllib.request import url2pathname

    try:
        origin = distribution(PROJECT).read_text("direct_url.json")  # PEP 610
    except PackageNotFoundError:
        return _checkout(Path(__file__).parents[2], extra)
    if origin is None:
        return (f"{PROJECT}[{extra}]",)
    found = json.loads(origin)
    url = found["url"]
    if "dir_info" in found:
        folder = Path(url2pathname(urlsplit(url).path))
        return _checkout(folder, extra, found["dir_info"].get("editable", False))
    if "vcs_info" in found:
        url = f"{found['vcs_info']['vcs']}+{url}@{found['vcs_info']['commit_id']}"
    return (f"{PROJECT}[{extra}] @ {url}",)


def _checkout(folder: Path, extra: str, editable: bool = True) -> tuple[str, ...]:
    return (*(("-e",) if editable else ()), f"{folder}[{extra}]")
