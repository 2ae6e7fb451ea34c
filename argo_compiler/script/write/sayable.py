"""What of a mission no script can say is refused, so that nothing is dropped in silence."""

from collections.abc import Collection

from argo_compiler.model import Model
from argo_compiler.script.write.text import UnwritableError


def require_sayable(part: Model, said: Collection[str], within: str = "") -> None:
    """That the fields outside of `said` are what is meant where nothing is said of them.

    Raises UnwritableError with the names of those that are not.
    """
    fields = type(part).model_fields
    lost = [
        f"`{within}{name}`"
        for name, field in fields.items()
        if name not in said and getattr(part, name) != field.get_default(call_default_factory=True)
    ]
    if lost:
        raise UnwritableError(f"can't be said in a script yet: {', '.join(lost)}")
