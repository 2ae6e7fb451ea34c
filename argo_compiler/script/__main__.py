"""Command that generates files from the grammar: `python -m argo_compiler.script [PAGE]`.

It writes the parser's tables, the lexicons and, if the page `docs/script.md` is given, the
reference between the page's markers.
"""

import sys
from importlib.resources import files
from pathlib import Path

from argo_compiler.script.reference import BEGIN, END, as_markdown
from argo_compiler.script.sentences.grammar.tables import save_tables
from argo_compiler.script.sentences.words.loading import LANGUAGES, save_lexicons

if __name__ == "__main__":
    save_tables(Path(str(files("argo_compiler.script.sentences.grammar"))))
    save_lexicons(Path(str(files("argo_compiler.script.sentences.words"))))
    for argument in sys.argv[1:]:
        page = Path(argument)
        text = page.read_text(encoding="utf-8")
        before, after = text.partition(BEGIN)[0], text.partition(END)[2]
        said = as_markdown(LANGUAGES)
        page.write_text(f"{before}{BEGIN}\n{said}\n{END}{after}", encoding="utf-8")
