"""What is told over WebSockets, for the OpenAPI document: each socket as a webhook of its own,
whose answer is one of its messages."""

from fastapi import APIRouter

from argo_planner.service.rooms.messages import RoomMessage
from argo_planner.service.runs.state import RunMessage

webhooks = APIRouter()


@webhooks.get("mission", operation_id="mission_told", response_model=RoomMessage)
def mission_told() -> None:
    """What `/api/missions/{id}/live` sends, message by message."""


@webhooks.get("robot", operation_id="robot_told", response_model=RunMessage)
def robot_told() -> None:
    """What `/api/robot/live` sends, message by message."""
