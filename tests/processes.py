"""Python in a process of its own."""

import subprocess
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]


def run_python(*arguments: object, **options: Any) -> subprocess.CompletedProcess[str]:
    """Runs Python with arguments to its end, which is a good one, in the project's folder.

    Options are those of `subprocess.run`.
    """
    usual = {"cwd": ROOT, "capture_output": True, "text": True, "timeout": 300, "check": True}
    return subprocess.run([sys.executable, *map(str, arguments)], **(usual | options))
