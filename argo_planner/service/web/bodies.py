"""The bodies of requests, read as strictly as the OpenAPI document says."""

import json
from collections.abc import Callable
from types import UnionType
from typing import Annotated, Any, TypeVar, Union, get_origin

from fastapi.exceptions import RequestValidationError
from pydantic import Discriminator, GetCoreSchemaHandler, TypeAdapter, ValidationError
from pydantic_core import core_schema

T = TypeVar("T")


class StrictJson:
    """Marks the type of a body in which a text such as "1.5" is no number.

    FastAPI has parsed the JSON before pydantic sees it, and pydantic's strict mode then wants
    tuples and members of enumerations, which no JSON has; so the body is validated as JSON again.
    """

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        # Pydantic has taken off what tells the kinds of a union apart.
        union = get_origin(source) in (Union, UnionType)
        body: Any = Annotated[source, Discriminator("kind")] if union else source
        adapter = TypeAdapter[Any](body)

        def validated(given: Any, leniently: Callable[[Any], Any]) -> Any:
            if isinstance(given, bytes):  # by its header it is no JSON
                return leniently(given)
            try:
                return adapter.validate_json(json.dumps(given), strict=True)
            except ValidationError as error:
                faults = [{**fault, "loc": ("body", *fault["loc"])} for fault in error.errors()]
                raise RequestValidationError(faults) from None

        return core_schema.no_info_wrap_validator_function(validated, handler(source))


Sent = Annotated[T, StrictJson()]
"""the body of a request: Sent[NameGiven]"""
