"""Routes for the planner page: the files that a bundler makes from `argo_planner/page`."""

import gzip
import mimetypes
import os
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from pathlib import Path

from fastapi import APIRouter, Request, Response
from fastapi.responses import HTMLResponse

from argo_compiler.base.errors import NotFound
from argo_compiler.base.message import Message

router = APIRouter(include_in_schema=False)

_IMMUTABLE = "private, max-age=31536000, immutable"  # the files' names have a hash of the content
_NOT_BUILT = """<!doctype html><html lang=en><meta charset=utf-8><title>Argo</title>
<h1>The planning service is running, but the page has not been built</h1>
<p>In a checkout of Argo, <code>make page</code> builds it; then load this page again.</p>
<p>Programs use the service's <a href=/api/openapi.json>interface</a>.</p></html>"""


@dataclass(frozen=True)
class PageFile:
    """A file of the page, also compressed if that saves anything."""

    content: bytes
    compressed: bytes | None

    def response(self, request: Request, media: str, cache_control: str) -> Response:
        """Return the file, compressed if the client accepts that."""
        headers = {"cache-control": cache_control, "vary": "accept-encoding"}
        accepted = request.headers.get("accept-encoding", "")
        if self.compressed is None or not _accepts_gzip(accepted):
            return Response(self.content, media_type=media, headers=headers)
        return Response(
            self.compressed, media_type=media, headers=headers | {"content-encoding": "gzip"}
        )


def _accepts_gzip(accepted: str) -> bool:
    """Return True if an Accept-Encoding header allows gzip, which a quality of 0 excludes."""
    for part in accepted.split(","):
        coding, _, quality = part.partition(";")
        if coding.strip().lower() in ("gzip", "*"):
            return quality.replace(" ", "").lower() not in ("q=0", "q=0.0", "q=0.00", "q=0.000")
    return False


@router.get("/")
async def show_page(request: Request) -> Response:
    """Return the planner page, or a hint on how to build it."""
    index = _load_files().get("index.html")
    if index is None:
        return HTMLResponse(_NOT_BUILT, headers={"cache-control": "no-store"})
    return index.response(request, "text/html", "no-cache")


@router.get("/assets/{name}")
async def show_asset(request: Request, name: str) -> Response:
    """Return a file of the planner page, such as a script, by its name.

    The files are those in the folder `assets` of the built page. Raises NotFound if none of them
    has this name.
    """
    file = _load_files().get(f"assets/{name}")
    if file is None:
        raise NotFound(
            Message("the page has no file {name}: load the page again", name=repr(name[:80]))
        )
    media = mimetypes.guess_type(name)[0] or "application/octet-stream"
    return file.response(request, media, _IMMUTABLE)


def page_folder_path() -> Path:
    """Return the folder of the built planner page."""
    return Path(str(files("argo_planner"))) / "page" / "dist"


def _load_files() -> Mapping[str, PageFile]:
    """Return the files of the planner page by their paths; empty if it has not been built."""
    folder = page_folder_path()
    try:
        return _read_files(folder, os.stat(folder / "index.html").st_mtime_ns)
    except OSError:
        return {}


@cache
def _read_files(folder: Path, _modified: int) -> Mapping[str, PageFile]:
    assets = sorted((folder / "assets").iterdir()) if os.path.isdir(folder / "assets") else []
    paths = [folder / "index.html", *assets]
    return {path.relative_to(folder).as_posix(): _read_file(path) for path in paths}


def _read_file(path: Path) -> PageFile:
    content = path.read_bytes()
    compressed = gzip.compress(content, mtime=0)
    return PageFile(content, compressed if len(compressed) < len(content) else None)
