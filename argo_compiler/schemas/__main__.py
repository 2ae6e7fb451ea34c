"""`python -m argo_compiler.schemas` writes the shipped schemas anew."""

from argo_compiler.schemas import SchemaName, schema_path
from argo_compiler.schemas.generate import schema_text

for name in SchemaName:
    schema_path(name).write_text(schema_text(name), encoding="utf-8", newline="\n")
