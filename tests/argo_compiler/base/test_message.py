"""Messages: English texts with templates and parameters, on the wire and in German."""

import json
import pickle
from collections.abc import Mapping
from pathlib import Path

import pytest

from argo_compiler.base.errors import Invalid, with_message_prefix
from argo_compiler.base.listing import brief_quoted_list, listed
from argo_compiler.base.message import Listing, Message
from argo_compiler.base.model import Model
from argo_compiler.base.quantity_text import duration_text
from argo_compiler.base.translation import in_german
from argo_compiler.base.wording import Text, Wording, worded, wording_field, wording_of
from argo_compiler.diagnostics import diagnostic_of
from argo_compiler.il import EventKind

EXAMPLES = Path(__file__).parents[3] / "argo_planner/page/test/texts/message-examples.json"
"""messages with their wordings in both languages, which the tests of the page compare as well"""

REACTION = Message("there is more than one reaction to {event}", event=EventKind.GAS_LEAK)
MESSAGES = (
    Message("remove it"),
    Message("more than one task is named '{task}'", task="Valve 4"),
    Message("after task '{task}'", task="remove it"),
    REACTION,
    Message("the mission never ends: {why}", why=REACTION),
    Message("{low:g} to {high:g}", low=0.5, high=1234.5),
    Message("from {level:.0%} to {goal:.0%}, which takes at least {least}", level=0.2, goal=0.855,
            least=duration_text(45.72)),
    Message("recharge to a lower level (it charges {rate:.1f} % in a minute)", rate=2.345),
    Message("the mission may take up to {most_duration}, longer than its maximum duration of "
            "{limit} (longest: {bound_path})", most_duration=duration_text(7384),
            limit=duration_text(3600), bound_path=Message("{path:>}", path=("A", "B"))),
    Message("choose {what} {values:or}", what=Message("the site"), values=("a", "b", "c")),
    Message("{names} can't be reached either", names=brief_quoted_list(list("ABCDEFGH"))),
    Message("tasks {names}", names=listed(["A"])),
    Message("there are: {known}", known=(1, 2)),
    Message("; only a failed measurement leads elsewhere") + REACTION,
)  # fmt: skip


class Told(Model):
    """Record with a text and its wording."""

    text: Text
    text_wording: Wording | None = wording_field("text")


@pytest.mark.parametrize("message", MESSAGES, ids=str)
def test_a_message_stays_one_on_its_way(message: Message) -> None:
    assert str(message) is message
    assert pickle.loads(pickle.dumps(message)).parameters == message.parameters
    told = Told(text=message)
    assert told.text is message
    sent = Told.model_validate_json(told.model_dump_json())
    assert sent == told
    assert type(sent.text) is str
    received = worded(sent.text, sent.text_wording)
    assert received == message
    assert received.template == message.template
    assert in_german(received) == in_german(message)


def test_the_page_has_the_same_examples() -> None:
    told = [
        {
            "text": text,
            "wording": None if (wording := wording_of(text)) is None else wording.model_dump(),
            "german": in_german(text),
        }
        for text in MESSAGES
    ]
    assert json.loads(EXAMPLES.read_text(encoding="utf-8")) == json.loads(json.dumps(told))


@pytest.mark.parametrize(
    ("text", "german"),
    [
        ("remove it", "entfernen Sie das"),
        ("a text of another program", "a text of another program"),
        (REACTION, "es gibt mehrere Reaktionen auf „Gasleck“"),
        (duration_text(45.72), "45,7 s"),
        (Message("{rate:.1f} / {count:,}", rate=2.25, count=12345), "2,2 / 12.345"),
        (Message("{share:.1%}", share=0.033), "3,3 %"),
        (listed(["a", "b", "c"], "or"), "a, b oder c"),
        (Message("{reasons:;}", reasons=[REACTION, "x"]), f"{in_german(REACTION)}; x"),
    ],
)
def test_german(text: str, german: str) -> None:
    assert in_german(text) == german


def test_parameters_are_not_translated_unless_they_are_messages() -> None:
    assert in_german(Message("after task '{task}'", task="remove it")) == "nach Aufgabe „remove it“"
    error = with_message_prefix(Invalid("remove it"), "round.json")
    assert in_german(str(error)) == "round.json: entfernen Sie das"


def test_messages_that_are_joined_stay_messages() -> None:
    both = Message("remove it") + ", " + REACTION
    assert both == f"remove it, {REACTION}"
    assert in_german(both) == f"entfernen Sie das, {in_german(REACTION)}"


def test_kinds_of_parameters() -> None:
    values: Mapping[str, object] = {
        "path": Path("a/b"),
        "flag": True,
        "error": ValueError("no"),
        "items": [1, "x"],
    }
    message = Message("{path} {flag} {error} {items}", **values)
    assert message == "a/b True no 1, x"
    assert message.parameters["items"] == Listing((1, "x"))
    assert isinstance(message.parameters["error"], Message)


def test_a_diagnostic_carries_its_wording() -> None:
    found = diagnostic_of("il.no-dock", REACTION, "remove it")
    assert found.message_wording == Wording(
        template=REACTION.template,
        parameters={"event": Wording(template="gas_leak", parameters={})},
    )
    assert found.hint_wording is None
