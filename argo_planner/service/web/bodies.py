"""Bodies of requests, validated as strictly as the OpenAPI document states."""

import json
from collections.abc import Callable
from types import UnionType
from typing import Annotated, Any, TypeVar, Union, get_origin

from fastapi.exceptions import RequestValidationError
from pydantic import Discriminator, GetCoreSchemaHandler, TypeAdapter, ValidationError
from pydantic_core import core_schema

T = TypeVar("T")


class StrictJson:
    """Annotation for the type of a body in which a text such as "1.5" is not accepted as a number.

    FastAPI parses the JSON before pydantic validates it. For parsed data, pydantic's strict mode
    requires tuples and members of enumerations, which JSON does not have. The body is therefore
    written as JSON again and validated as such.
    """

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        # Pydantic has removed the discriminator of a union.
        union = get_origin(source) in (Union, UnionType)
        body: Any = Annotated[source, Discriminator("kind")] if union else source
        adapter = TypeAdapter[Any](body)

        def validate(given: Any, validate_leniently: Callable[[Any], Any]) -> Any:
            if isinstance(given, bytes):  # the content type is not JSON
                return validate_leniently(given)
            try:
                return adapter.validate_json(json.dumps(given), strict=True)
            except ValidationError as error:
                faults = [{**fault, "loc": ("body", *fault["loc"])} for fault in error.errors()]
                raise RequestValidationError(faults) from None

        return core_schema.no_info_wrap_validator_function(validate, handler(source))


JsonBody = Annotated[T, StrictJson()]
"""type of a request's body in a route: `JsonBody[NameGiven]`"""
