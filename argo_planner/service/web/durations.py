"""Route for durations that people type into forms."""

from typing import Annotated

from fastapi import Query, Response

from argo_compiler.script.durations import LONGEST_TEXT, DurationReading, read_duration
from argo_planner.service.web.requests import Viewer, json_response, make_router

router = make_router("durations")


@router.get("/durations", operation_id="read_duration", response_model=DurationReading)
async def read_duration_text(
    _: Viewer,
    text: Annotated[str, Query(max_length=LONGEST_TEXT, description="such as `1 h 30 min`")],
) -> Response:
    """Return what a text says as a duration, in the words and signs of scripts."""
    return json_response(read_duration(text))
