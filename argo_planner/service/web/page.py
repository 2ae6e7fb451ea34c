"""Routes for the planner page: the files that a bundler makes from `argo_planner/page`."""

import mimetypes
import os
from collections.abc import Mapping
from functools import cache
from importlib.resources import files
from pathlib import Path

from fastapi import APIRouter, Response
from fastapi.responses import HTMLResponse

from argo_compiler.base.errors import NotFound

router = APIRouter(include_in_schema=False)

_IMMUTABLE = "private, max-age=31536000, immutable"  # the files' names have a hash of the content
_NOT_BUILT = """<!doctype html><html lang=en><meta charset=utf-8><title>Argo</title>
<h1>The planning service is running, but the page has not been built</h1>
<p>In a checkout of Argo, <code>make page</code> builds it; then load this page again.</p>
<p>Programs use the service's <a href=/api/openapi.json>interface</a>.</p></html>"""


@router.get("/")
async def show_page() -> Response:
    """Return the planner page, or a hint on how to build it."""
    index = _load_files().get("index.html")
    if index is None:
        return HTMLResponse(_NOT_BUILT, headers={"cache-control": "no-store"})
    return Response(index, media_type="text/html", headers={"cache-control": "no-cache"})


@router.get("/assets/{name}")
async def show_asset(name: str) -> Response:
    """Return a file of the planner page, such as a script, by its name.

    The files are those in the folder `assets` of the built page. Raises NotFound if none of them
    has this name.
    """
    content = _load_files().get(f"assets/{name}")
    if content is None:
        raise NotFound(f"the page has no file {name[:80]!r}: load the page again")
    media = mimetypes.guess_type(name)[0] or "application/octet-stream"
    headers = {"cache-control": _IMMUTABLE, "vary": "accept-encoding"}
    return Response(content, media_type=media, headers=headers)


def page_folder_path() -> Path:
    """Return the folder of the built planner page."""
    return Path(str(files("argo_planner"))) / "page" / "dist"


def _load_files() -> Mapping[str, bytes]:
    """Return the files of the planner page by their paths; empty if it has not been built."""
    folder = page_folder_path()
    try:
        return _read_files(folder, os.stat(folder / "index.html").st_mtime_ns)
    except OSError:
        return {}


@cache
def _read_files(folder: Path, _modified: int) -> Mapping[str, bytes]:
    assets = sorted((folder / "assets").iterdir()) if os.path.isdir(folder / "assets") else []
    paths = [folder / "index.html", *assets]
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in paths}
