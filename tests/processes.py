"""Python in a separate process."""

import subprocess
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]


def run_python(*arguments: object, **options: Any) -> subprocess.CompletedProcess[str]:
    """Run Python with arguments in the project's folder, and require that it succeeds.

    `options` are those of `subprocess.run`; `check=False` accepts a failure.
    """
    usual = {"cwd": ROOT, "capture_output": True, "text": True, "timeout": 300, "check": True}
    return subprocess.run([sys.executable, *map(str, arguments)], **(usual | options))
