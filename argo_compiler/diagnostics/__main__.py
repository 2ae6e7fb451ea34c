"""Command `python -m argo_compiler.diagnostics`: print the tables of `docs/diagnostics.md`.

With the path of that page as its argument, it writes the tables there, between the marks.
"""

import sys
from pathlib import Path

from argo_compiler.diagnostics.codes import BEGIN, END, as_markdown

if len(sys.argv) < 2:
    print(as_markdown())
else:
    page = Path(sys.argv[1])
    text = page.read_text(encoding="utf-8")
    before, after = text.partition(BEGIN)[0], text.partition(END)[2]
    page.write_text(f"{before}{BEGIN}\n{as_markdown()}\n{END}{after}", encoding="utf-8")
