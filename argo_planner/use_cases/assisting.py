"""Suggestions of an assistant for the open lines of a draft."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from argo_compiler.base.catalog import Catalog
from argo_compiler.base.errors import ArgoError, with_message_prefix
from argo_compiler.base.message import Message

if TYPE_CHECKING:
    from argo_compiler.script import Draft
    from argo_compiler.script.assistant.suggestion import LineSuggestion

_URLS = ("http://", "https://")


@dataclass(frozen=True)
class Assistant:
    """A command or an endpoint that suggests sentences, and the limits of its work."""

    address: str
    """a command, or the URL of an endpoint"""
    model: str | None = None
    """of an endpoint"""
    key: str | None = None
    """of an endpoint; a secret"""
    timeout_s: float = 120.0

    @property
    def is_endpoint(self) -> bool:
        return self.address.lower().startswith(_URLS)

    @property
    def place(self) -> str:
        """The command, or the URL that requests go to."""
        if not self.is_endpoint:
            return self.address
        from argo_planner.assistant.endpoint import endpoint_url

        return endpoint_url(self.address)


def suggest_lines(
    draft: "Draft", catalog: Catalog, assistant: Assistant, announce: Callable[[str], None]
) -> "tuple[LineSuggestion, ...] | None":
    """Ask an assistant about the open lines of a draft, and return all suggestions.

    Returns None if there is no line to ask about. `announce` is called with what is sent, before
    it is sent.

    Raises:
        ArgoError: The assistant does not answer, or not in the form that it is asked for.
    """
    from argo_compiler.script.assistant.answer import MAX_ANSWER_BYTES, read_answer
    from argo_compiler.script.assistant.request import make_request
    from argo_compiler.script.drafts.suggesting import lines_to_ask, suggestions_from

    asked = lines_to_ask(draft)
    if not asked:
        return None
    place = assistant.place
    request = make_request(draft.text, (line.line for line in asked), catalog)
    size = len(request.text.encode("utf-8"))
    announce(
        Message(
            "sending to the assistant `{place}`: the script ({script_lines} lines, "
            "{count} of them open), the {checkpoints} checkpoints of {site} and a "
            "description of the language, {size:,} bytes",
            place=place,
            script_lines=request.script_lines,
            count=len(asked),
            checkpoints=request.checkpoints,
            site=catalog.site,
            size=size,
        )
    )
    # Imported late: most commands ask no assistant.
    try:
        if assistant.is_endpoint:
            from argo_planner.assistant.endpoint import ask_endpoint

            content = ask_endpoint(
                place,
                request,
                assistant.model,
                assistant.key,
                MAX_ANSWER_BYTES,
                assistant.timeout_s,
            )
        else:
            from argo_planner.assistant.command import ask_command

            content = ask_command(place, request.text, MAX_ANSWER_BYTES, assistant.timeout_s)
        entries = read_answer(content)
    except ArgoError as error:
        raise with_message_prefix(error, Message("the assistant `{place}`", place=place)) from None
    return suggestions_from(draft, entries)
