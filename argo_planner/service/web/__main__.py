"""Command that writes the OpenAPI document.

`python -m argo_planner.service.web docs/openapi.json`
"""

import sys
from pathlib import Path

from argo_planner.service.web.app import openapi_document

if __name__ == "__main__":
    Path(sys.argv[1]).write_text(openapi_document(), encoding="utf-8")
