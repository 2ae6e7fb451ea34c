"""Writes the OpenAPI document: `python -m argo_planner.service.web docs/openapi.json`."""

import sys
from pathlib import Path

from argo_planner.service.web.app import document

if __name__ == "__main__":
    Path(sys.argv[1]).write_text(document(), encoding="utf-8")
