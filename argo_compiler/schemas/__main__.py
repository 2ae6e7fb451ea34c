"""Command `python -m argo_compiler.schemas`, which generates the shipped schemas."""

from argo_compiler.schemas import SchemaName, schema_path
from argo_compiler.schemas.generate import schema_text

for name in SchemaName:
    schema_path(name).write_text(schema_text(name), encoding="utf-8", newline="\n")
