"""Language of messages: English, or German by `--language` or the variable ARGO_LANGUAGE."""

import os
from enum import StrEnum

VARIABLE = "ARGO_LANGUAGE"


class MessageLanguage(StrEnum):
    """MessageLanguage of the messages of the command."""

    ENGLISH = "en"
    GERMAN = "de"


def set_language(language: MessageLanguage | None) -> None:
    """Set the language of all further messages; None leaves that of the environment."""
    if language is not None:
        os.environ[VARIABLE] = language


def in_chosen_language(text: str) -> str:
    """Return a message in the chosen language.

    The catalogue of German messages is read only if German is chosen.
    """
    if os.environ.get(VARIABLE, "")[:2].lower() != MessageLanguage.GERMAN:
        return text
    from argo_compiler.base.translation import in_german

    return in_german(text)
