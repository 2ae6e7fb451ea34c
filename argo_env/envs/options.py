"""What `reset(options=...)` and a constructor's arguments have in common: they are checked."""

from collections.abc import Mapping
from typing import Any, TypeVar

from pydantic import ValidationError

from argo_compiler.errors import ArgoError
from argo_compiler.model import Model

Options = TypeVar("Options", bound=Model)


def read_options(model: type[Options], given: Mapping[str, Any], env: str) -> Options:
    """The options as data; ArgoError that names what is wrong, and what there is."""
    try:
        return model.model_validate(dict(given))
    except ValidationError as error:
        known = ", ".join(model.model_fields)
        wrong = "; ".join(
            f"`{'.'.join(map(str, e['loc']))}`: {e['msg'].removeprefix('Value error, ')}"
            for e in error.errors()
        )
        raise ArgoError(f"options of {env}: {wrong}; there are: {known}") from None
